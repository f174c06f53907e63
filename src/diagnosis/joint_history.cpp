// SPDX-License-Identifier: BSD-3-Clause
// Effects applied from step to step of a timeline (timeline.h): all of them, or those only that
// another simulation has otherwise.
#include <algorithm>
#include <utility>

#include "timeline.h"

namespace raven_correction {
namespace {

/// What acts on the joints. The first effects up to the last that remembers run at every step, the
/// rest where the joints are seen.
struct Chain {
  std::vector<const Effect*> effects;
  std::size_t running = 0, drives = 0;
};

Chain chainOf(const SimulationConfig& simulation) {
  Chain chain;
  for (const auto& effect : simulation.effects) {
    const EffectStage stage = effect->stage();
    if (stage != EffectStage::kDrive && stage != EffectStage::kCable) continue;
    chain.effects.push_back(effect.get());
    if (stage == EffectStage::kDrive) chain.drives = chain.effects.size();
    if (effect->remembers()) chain.running = chain.effects.size();
  }
  return chain;
}

/// Applies the effects from the `first` on to what enters it at every step.
/// @param history   made before the first effect: its motors stay where they come before it
/// @param trace     if not null: what enters each effect that runs at every step, and the next one
void apply(const Timeline& timeline, const SimulationConfig& simulation, const Chain& chain,
           std::size_t first, const Eigen::MatrixXd& entering, JointHistory& history,
           std::vector<Eigen::MatrixXd>* trace) {
  const std::vector<const Effect*>& effects = chain.effects;
  const JointVector no_load = JointVector::Zero(timeline.setpoints.rows());
  const JointMatrix travel = simulation.coupling.empty()
                                 ? JointMatrix()
                                 : simulation.coupling.motorTravel(simulation.robot);
  std::vector<JointVector> memory(effects.size(), no_load);
  JointVector q = no_load, motor = no_load, unused = no_load;
  const bool every_step = chain.running > first;
  std::size_t seen = 0;
  for (std::size_t k = 0; k < timeline.steps.size() && seen < timeline.observed.size(); ++k) {
    if (!every_step) k = timeline.observed[seen];
    const auto column = static_cast<Eigen::Index>(k);
    const Timeline::Step& step = timeline.steps[k];
    const StepContext context{step.end, step.length, simulation.robot.home(), no_load,
                              travel.size() > 0 ? &travel : nullptr};
    q = entering.col(column);
    for (std::size_t i = first; i < chain.running; ++i) {
      if (i == chain.drives) motor = q;
      if (trace && i > 0) (*trace)[i].col(column) = q;
      if (step.rest) memory[i] = q;
      effects[i]->apply(context, memory[i], q);
    }
    if (trace && chain.running > 0) (*trace)[chain.running].col(column) = q;
    if (timeline.observed[seen] != k) continue;
    for (std::size_t i = std::max(first, chain.running); i < effects.size(); ++i) {
      if (i == chain.drives) motor = q;
      effects[i]->apply(context, unused, q);
    }
    if (chain.drives == effects.size()) motor = q;
    for (; seen < timeline.observed.size() && timeline.observed[seen] == k; ++seen) {
      const auto sample = static_cast<Eigen::Index>(seen);
      if (chain.drives >= first) history.motor.col(sample) = motor;
      history.joint.col(sample) = q;
      history.since_start(sample) = step.end;
    }
  }
}

JointHistory emptyHistory(const Timeline& timeline) {
  const Eigen::Index joints = timeline.setpoints.rows();
  const auto count = static_cast<Eigen::Index>(timeline.observed.size());
  return {Eigen::MatrixXd(joints, count), Eigen::MatrixXd(joints, count), Eigen::VectorXd(count)};
}

}  // namespace

JointHistory jointHistory(const Timeline& timeline, const SimulationConfig& simulation) {
  JointHistory history = emptyHistory(timeline);
  apply(timeline, simulation, chainOf(simulation), 0, timeline.setpoints, history, nullptr);
  return history;
}

TracedHistory::TracedHistory(std::shared_ptr<const Timeline> timeline,
                             const SimulationConfig& simulation)
    : timeline_(std::move(timeline)), simulation_(simulation), history_(emptyHistory(*timeline_)) {
  const Chain chain = chainOf(simulation_);
  entering_.resize(chain.running + 1);
  for (std::size_t i = 1; i < entering_.size(); ++i)
    entering_[i].resize(timeline_->setpoints.rows(), timeline_->setpoints.cols());
  apply(*timeline_, simulation_, chain, 0, timeline_->setpoints, history_, &entering_);
}

JointHistory TracedHistory::of(const SimulationConfig& other) const {
  const Chain mine = chainOf(simulation_), theirs = chainOf(other);
  const std::size_t most = std::min(mine.effects.size(), theirs.effects.size());
  std::size_t first = 0;
  while (first < most && mine.effects[first] == theirs.effects[first]) ++first;
  if (first == mine.effects.size() && first == theirs.effects.size()) return history_;
  first = std::min(first, mine.running);
  JointHistory history = history_;
  apply(*timeline_, other, theirs, first, first == 0 ? timeline_->setpoints : entering_[first],
        history, nullptr);
  return history;
}

}  // namespace raven_correction
