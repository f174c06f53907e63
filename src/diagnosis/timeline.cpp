// SPDX-License-Identifier: BSD-3-Clause
#include "timeline.h"

#include <algorithm>
#include <new>
#include <utility>

#include "raven_correction/error.h"
#include "raven_correction/simulation/simulated_arm.h"

namespace raven_correction {
namespace {

constexpr double kPause = 0.2;  // between motions; shorter: one goes on where the other ends [s]
// A command of the very stamp of an observation has been carried out: recordings that go from stop
// to stop have one stamp for both [s].
constexpr double kAfter = 1e-6;
constexpr double kLongestStep = 0.1;     // every operator is exact for held set-points [s]
constexpr std::size_t kMostEntries = 8;  // two for each processor would do

/// Feeds the arm the set-points of one motion after the other.
class Replay {
 public:
  explicit Replay(const SimulationConfig& simulation) : arm_(simulation) {}

  /// @return whether the arm was put at rest
  bool begin(const Recording::Motion& motion) {
    motion_ = &motion;
    next_ = fresh_ ? 0 : motion.carried;
    if (next_ > 0) return false;
    const Recording::Setpoint& first = motion.setpoints.front();
    const double start = std::min(first.stamp, motion.observations.front().stamp);
    const bool rests = fresh_ || start < arm_.time();
    if (rests) {
      arm_.reset(start, first.joints);
      fresh_ = false;
    } else if (first.stamp - arm_.state().last_stamp > kPause) {
      arm_.command(std::max(arm_.time(), arm_.state().last_stamp), first.joints);
    }
    return rests;
  }
  /// The arm at this instant of the motion.
  const SimulatedArm& at(double stamp) {
    // One set-point beyond the instant, because linear set-points look ahead.
    while (next_ < motion_->setpoints.size() &&
           (next_ == 0 || motion_->setpoints[next_ - 1].stamp <= stamp))
      take();
    arm_.advanceTo(stamp + kAfter);
    return arm_;
  }
  void end() {
    while (next_ < motion_->setpoints.size()) take();
  }

 private:
  void take() {
    const Recording::Setpoint& setpoint = motion_->setpoints[next_++];
    arm_.command(setpoint.stamp, setpoint.joints);
  }
  SimulatedArm arm_;
  const Recording::Motion* motion_ = nullptr;
  std::size_t next_ = 0;
  bool fresh_ = true;
};

SimulationConfig coarse(SimulationConfig config) {
  config.step = kLongestStep;
  return config;
}

/// No effect of the robot: writes down every step that is taken, and its set-point.
class StepLog : public Effect {
 public:
  struct Log {
    std::vector<Timeline::Step> steps;
    std::vector<JointVector> setpoints;
    bool complete = true;  // false: there was no memory for a step
  };
  explicit StepLog(Log& log) : log_(log) {}
  const char* name() const noexcept override { return "step_log"; }
  EffectStage stage() const noexcept override { return EffectStage::kDrive; }
  const char* equation() const noexcept override { return "q = q"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<StepLog>(*this); }
  void apply(const StepContext& context, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    try {  // nothing may leave an effect
      log_.steps.push_back({context.time, context.step, false});
      log_.setpoints.push_back(q);
    } catch (const std::exception&) {
      log_.complete = false;
    }
  }

 private:
  Log& log_;
};

std::size_t countObservations(const Recording& recording) {
  std::size_t count = 0;
  for (const Recording::Motion& motion : recording.motions) count += motion.observations.size();
  return count;
}

}  // namespace

Timeline makeTimeline(const Recording& recording, const SimulationConfig& simulation) {
  Timeline timeline;
  StepLog::Log log;
  // About so many: every set-point and every observation ends a step.
  std::size_t expected = countObservations(recording);
  for (const Recording::Motion& motion : recording.motions) expected += motion.setpoints.size();
  log.steps.reserve(expected);
  log.setpoints.reserve(expected);
  SimulationConfig config = coarse(simulation);
  config.effects.clear();
  for (const auto& effect : simulation.effects)
    if (effect->stage() == EffectStage::kCommand) config.effects.push_back(effect);
  config.effects.push_back(std::make_shared<StepLog>(log));
  Replay replay(config);  // rests once for itself, as begin() does anew
  log.steps.clear();
  log.setpoints.clear();
  for (const Recording::Motion& motion : recording.motions) {
    if (replay.begin(motion)) log.steps.back().rest = true;
    for (const Recording::Observation& observation : motion.observations) {
      replay.at(observation.stamp);
      timeline.observed.push_back(log.steps.size() - 1);
    }
    replay.end();
  }
  if (!log.complete) throw std::bad_alloc();
  timeline.steps = std::move(log.steps);
  timeline.setpoints.resize(recording.robot.size(),
                            static_cast<Eigen::Index>(log.setpoints.size()));
  for (std::size_t k = 0; k < log.setpoints.size(); ++k)
    timeline.setpoints.col(static_cast<Eigen::Index>(k)) = log.setpoints[k];
  return timeline;
}

JointHistory steppedJointHistory(const Recording& recording, const SimulationConfig& simulation) {
  const auto count = static_cast<Eigen::Index>(countObservations(recording));
  const Eigen::Index joints = recording.robot.size();
  JointHistory history{Eigen::MatrixXd(joints, count), Eigen::MatrixXd(joints, count),
                       Eigen::VectorXd(count)};
  Replay replay(coarse(simulation));
  Eigen::Index column = 0;
  for (const Recording::Motion& motion : recording.motions) {
    replay.begin(motion);
    for (const Recording::Observation& observation : motion.observations) {
      const SimulatedArm& arm = replay.at(observation.stamp);
      history.motor.col(column) = arm.motorJoints();
      history.joint.col(column) = arm.joints();
      history.since_start(column++) = arm.sinceStart();
    }
    replay.end();
  }
  return history;
}

std::shared_ptr<const Timeline> TimelineCache::find(SetpointMode setpoints, double delay) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.setpoints == setpoints && entry.delay == delay;
  });
  if (found == entries_.end()) return nullptr;
  std::rotate(found, found + 1, entries_.end());
  return entries_.back().timeline;
}

std::shared_ptr<const Timeline> TimelineCache::of(const Recording& recording,
                                                  const SimulationConfig& simulation) {
  double delay = 0.0;
  for (const auto& effect : simulation.effects) delay += effect->delay();
  const auto checked = [&](std::shared_ptr<const Timeline> timeline) {
    const std::size_t count = countObservations(recording);
    if (timeline && timeline->observed.size() != count)
      throw InvalidInput(
          format("%s: %zu observations, but its residual layout was made of %zu; "
                 "make another layout for another or changed recording",
                 recording.name.c_str(), count, timeline->observed.size()));
    return timeline;
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (auto kept = checked(find(simulation.setpoints, delay))) return kept;
  }
  auto timeline = std::make_shared<const Timeline>(makeTimeline(recording, simulation));
  const std::lock_guard<std::mutex> lock(mutex_);
  if (auto kept = checked(find(simulation.setpoints, delay))) return kept;  // made meanwhile
  if (entries_.size() == kMostEntries) entries_.erase(entries_.begin());
  entries_.push_back({simulation.setpoints, delay, timeline});
  return timeline;
}

}  // namespace raven_correction
