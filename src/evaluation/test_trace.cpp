// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/test_trace.h"

#include "raven_correction/error.h"

namespace raven_correction {

TraceResult testTrace(const Dataset& dataset, const TraceProblem& problem,
                      const Progress& progress) {
  if (problem.states == 0) throw InvalidInput("0 test states, must be at least 1");
  const HoldOut& hold_out = problem.hold_out;
  const Dataset training = selectFold(dataset, hold_out, false);
  const Dataset test = selectFold(dataset, hold_out, true);
  if (test.trajectories.empty())
    throw InvalidInput(format("%s: none of %zu trajectories is in fold %d of %d",
                              dataset.source.c_str(), dataset.trajectories.size(), hold_out.fold,
                              hold_out.folds));
  const TrainingResult learnt = train(training, problem.config, 0.0, progress);
  const Predictor predictor(learnt.model);
  const std::vector<TestState> states =
      makeTestStates(test, learnt.model.motion, learnt.model.delay,
                     commandGapLimit(training, problem.config), problem.gates);
  const std::vector<bool> clean = cleanStates(states, learnt.model.rigid, problem.gates);

  TraceResult result;
  result.test_trajectories = test.trajectories.size();
  result.n_train = learnt.model.training_pairs;
  result.delay = learnt.model.delay;
  std::vector<PoseError> none, rigid, full;
  const auto workspace = predictor.makeWorkspace();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!clean[i]) continue;
    ++result.clean_states;
    if (result.states.size() == problem.states) continue;
    const Prediction prediction = predictor.predict(states[i].motion, *workspace);
    result.states.push_back({states[i].trajectory, states[i].command, states[i].motion.pose,
                             prediction.rigid, prediction.command, prediction.sd_position});
    const TraceState& state = result.states.back();
    none.push_back(poseError(state.observed, state.command));
    rigid.push_back(poseError(state.rigid, state.command));
    full.push_back(poseError(state.full, state.command));
  }
  if (result.states.empty())
    throw InvalidInput(
        format("%s: no test state of fold %d passes the gates of the clean set; are commands and "
               "observations in the same frame and in metres?",
               dataset.source.c_str(), hold_out.fold));
  result.none = summarise(none);
  result.rigid = summarise(rigid);
  result.full = summarise(full);
  return result;
}

}  // namespace raven_correction
