// SPDX-License-Identifier: BSD-3-Clause
#include "timeline.h"

#include <algorithm>

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
    next_ = 0;
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
  StepLog(std::vector<Timeline::Step>& steps, std::vector<JointVector>& setpoints)
      : steps_(steps), setpoints_(setpoints) {}
  const char* name() const noexcept override { return "step_log"; }
  EffectStage stage() const noexcept override { return EffectStage::kDrive; }
  const char* equation() const noexcept override { return "q = q"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<StepLog>(*this); }
  void apply(const StepContext& context, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    steps_.push_back({context.time, context.step, false});
    setpoints_.push_back(q);
  }

 private:
  std::vector<Timeline::Step>& steps_;
  std::vector<JointVector>& setpoints_;
};

std::size_t countObservations(const Recording& recording) {
  std::size_t count = 0;
  for (const Recording::Motion& motion : recording.motions) count += motion.observations.size();
  return count;
}

JointHistory emptyHistory(Eigen::Index joints, std::size_t observations) {
  const auto count = static_cast<Eigen::Index>(observations);
  return {Eigen::MatrixXd(joints, count), Eigen::MatrixXd(joints, count), Eigen::VectorXd(count)};
}

}  // namespace

Timeline makeTimeline(const Recording& recording, const SimulationConfig& simulation) {
  Timeline timeline;
  std::vector<JointVector> setpoints;
  SimulationConfig config = coarse(simulation);
  config.effects.clear();
  for (const auto& effect : simulation.effects)
    if (effect->stage() == EffectStage::kCommand) config.effects.push_back(effect);
  config.effects.push_back(std::make_shared<StepLog>(timeline.steps, setpoints));
  Replay replay(config);  // rests once for itself, as begin() does anew
  timeline.steps.clear();
  setpoints.clear();
  for (const Recording::Motion& motion : recording.motions) {
    if (replay.begin(motion)) timeline.steps.back().rest = true;
    for (const Recording::Observation& observation : motion.observations) {
      replay.at(observation.stamp);
      timeline.observed.push_back(timeline.steps.size() - 1);
    }
    replay.end();
  }
  timeline.setpoints.resize(recording.robot.size(), static_cast<Eigen::Index>(setpoints.size()));
  for (std::size_t k = 0; k < setpoints.size(); ++k)
    timeline.setpoints.col(static_cast<Eigen::Index>(k)) = setpoints[k];
  return timeline;
}

JointHistory jointHistory(const Timeline& timeline, const SimulationConfig& simulation) {
  // The first effects up to the last that remembers run at every step, the rest where it is seen.
  std::vector<const Effect*> chain;
  std::size_t running = 0, drives = 0;
  for (const auto& effect : simulation.effects) {
    const EffectStage stage = effect->stage();
    if (stage != EffectStage::kDrive && stage != EffectStage::kCable) continue;
    chain.push_back(effect.get());
    if (stage == EffectStage::kDrive) drives = chain.size();
    if (effect->remembers()) running = chain.size();
  }
  const Eigen::Index n = timeline.setpoints.rows();
  const JointVector no_load = JointVector::Zero(n);
  const JointMatrix travel = simulation.coupling.empty()
                                 ? JointMatrix()
                                 : simulation.coupling.motorTravel(simulation.robot);
  JointHistory history = emptyHistory(n, timeline.observed.size());
  std::vector<JointVector> memory(chain.size(), no_load);
  JointVector q(n), motor(n), unused(n);
  std::size_t seen = 0;
  for (std::size_t k = 0; k < timeline.steps.size() && seen < timeline.observed.size(); ++k) {
    if (running == 0) k = timeline.observed[seen];
    const Timeline::Step& step = timeline.steps[k];
    const StepContext context{step.end, step.length, simulation.robot.home(), no_load,
                              travel.size() > 0 ? &travel : nullptr};
    q = timeline.setpoints.col(static_cast<Eigen::Index>(k));
    for (std::size_t i = 0; i < running; ++i) {
      if (i == drives) motor = q;
      if (step.rest) memory[i] = q;
      chain[i]->apply(context, memory[i], q);
    }
    if (timeline.observed[seen] != k) continue;
    for (std::size_t i = running; i < chain.size(); ++i) {
      if (i == drives) motor = q;
      chain[i]->apply(context, unused, q);
    }
    if (drives == chain.size()) motor = q;
    for (; seen < timeline.observed.size() && timeline.observed[seen] == k; ++seen) {
      const auto column = static_cast<Eigen::Index>(seen);
      history.motor.col(column) = motor;
      history.joint.col(column) = q;
      history.since_start(column) = step.end;
    }
  }
  return history;
}

JointHistory steppedJointHistory(const Recording& recording, const SimulationConfig& simulation) {
  JointHistory history = emptyHistory(recording.robot.size(), countObservations(recording));
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

std::shared_ptr<const Timeline> TimelineCache::of(const Recording& recording,
                                                  const SimulationConfig& simulation) {
  double delay = 0.0;
  for (const auto& effect : simulation.effects) delay += effect->delay();
  const auto is_this = [&](const Entry& entry) {
    return entry.setpoints == simulation.setpoints && entry.delay == delay;
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(), is_this);
    if (found != entries_.end()) {
      std::rotate(found, found + 1, entries_.end());
      return entries_.back().timeline;
    }
  }
  auto timeline = std::make_shared<const Timeline>(makeTimeline(recording, simulation));
  const std::lock_guard<std::mutex> lock(mutex_);
  if (entries_.size() == kMostEntries) entries_.erase(entries_.begin());
  entries_.push_back({simulation.setpoints, delay, timeline});
  return timeline;
}

}  // namespace raven_correction
