// SPDX-License-Identifier: BSD-3-Clause
// The steps that a simulated arm takes through a recording. They depend on set-points and delay
// alone, so simulations that differ in anything else share them, and each of their effects needs no
// more than to be applied from step to step. What comes out is, bit for bit, what SimulatedArm
// makes of the same set-points.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "raven_correction/diagnosis/recording.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

struct Timeline {
  struct Step {
    double end;     ///< since the start of the session [s]
    double length;  ///< [s]
    bool rest;      ///< no step but a reset: the arm rests at this set-point
  };
  std::vector<Step> steps;
  Eigen::MatrixXd setpoints;          ///< joints x steps
  std::vector<std::size_t> observed;  ///< step of every observation of the recording, in order
};

/// What the joints do at the observations, one column each.
struct JointHistory {
  Eigen::MatrixXd motor;        ///< motor side, in joint units: what encoders see
  Eigen::MatrixXd joint;        ///< joint side
  Eigen::VectorXd since_start;  ///< of the session [s]
};

/// From rest at the first set-point, without resets between motions unless time runs back.
/// @param simulation  its delay and its way from one set-point to the next count
Timeline makeTimeline(const Recording& recording, const SimulationConfig& simulation);

/// @param simulation  none of its effects needs a load, and its delay is that of the timeline
JointHistory jointHistory(const Timeline& timeline, const SimulationConfig& simulation);

/// jointHistory() of one simulation, and from there at little cost those of others that differ from
/// it in few effects: what comes before the first of these is remembered of every step.
class TracedHistory {
 public:
  /// @param simulation  as for jointHistory()
  TracedHistory(std::shared_ptr<const Timeline> timeline, const SimulationConfig& simulation);

  const Timeline& timeline() const { return *timeline_; }
  const JointHistory& history() const { return history_; }
  /// jointHistory(timeline(), other), bit for bit. What it shares with the simulation are the
  /// effects that are the very same objects, as withValues() leaves those that it does not change.
  JointHistory of(const SimulationConfig& other) const;

 private:
  std::shared_ptr<const Timeline> timeline_;
  SimulationConfig simulation_;
  std::vector<Eigen::MatrixXd> entering_;  // effect i of the chain, joints x steps; [0] is not used
  JointHistory history_;
};

/// The same for any simulation, step by step: the load of a joint depends on the step before.
JointHistory steppedJointHistory(const Recording& recording, const SimulationConfig& simulation);

/// Keeps the timelines that were asked for last, of one recording: it belongs to a layout, and a
/// layout to one recording that does not change as long as it is used. Thread-safe.
class TimelineCache {
 public:
  /// @throws InvalidInput  another number of observations than those of the timelines kept here: it
  ///         is another recording, or one that has been changed
  std::shared_ptr<const Timeline> of(const Recording& recording,
                                     const SimulationConfig& simulation);

 private:
  std::shared_ptr<const Timeline> find(SetpointMode setpoints, double delay);

  struct Entry {
    SetpointMode setpoints;
    double delay;
    std::shared_ptr<const Timeline> timeline;
  };
  std::mutex mutex_;
  std::vector<Entry> entries_;  // the newest last
};

}  // namespace raven_correction
