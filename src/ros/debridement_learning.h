// SPDX-License-Identifier: BSD-3-Clause
// How an arm of the debridement experiment learns before it works: it rehearses the motions of the
// task where nothing lies, twice, and is then looked at where it will work.
#pragma once

#include <functional>
#include <string>

#include "raven_correction/correction/training.h"
#include "raven_correction/report/debridement_report.h"
#include "raven_correction/ros/debridement_arm.h"
#include "raven_correction/ros/private_launch.h"

namespace raven_correction {

struct LearningPlan {
  unsigned arm = 0;
  unsigned arms = 2;          ///< that share the field
  unsigned rehearsals = 120;  ///< places of the second rehearsal; the first has half as many
  std::uint64_t seed = 1;     ///< of places
};

/// Records motions without correction, with the deviation undone that was measured once, and learns
/// from them where the arm errs; then, with what it has learnt in use, records the motions of the
/// task and learns from those. The second time the tool is where the task will have it, so that the
/// model does not extrapolate. Last it visits places like those of the task, and motion capture
/// says how far off it is. The corrector is in mode `full` then.
/// @param alone  runs a job of this arm while somebody looks after the nodes
/// @param tell   phase, and how far it is, 0 to 1
/// @throws std::runtime_error  a node did not do what it was asked
DebridementLearning learnDebridement(const LearningPlan& plan, DebridementArm& arm,
                                     PrivateLaunch& launch,
                                     const std::function<void(const std::function<void()>&)>& alone,
                                     const Progress& tell);

/// @throws std::runtime_error  the corrector of this arm does not take the mode
void setCorrectorMode(unsigned arm, const std::string& mode, PrivateLaunch& launch);

}  // namespace raven_correction
