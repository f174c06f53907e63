// SPDX-License-Identifier: BSD-3-Clause
// How far from its target the tool comes to rest, visit by visit: what a user sees of a correction,
// measured the same way before and after. Errors of the learnt map itself are test_states.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/evaluation/error_metrics.h"
#include "raven_correction/geometry/stream.h"

namespace raven_correction {

struct Visit {
  std::string name;         ///< of the trajectory
  Pose target;              ///< where the tool was to rest, in base
  PoseError error;          ///< target against the observed rest: components are target - observed
  std::size_t samples = 0;  ///< observations at rest
};

/// The visit of one target: component by component the median over the observations of the last
/// `rest` seconds before `end`, so that a marker that jumps does not count.
/// @param observations  in base, sorted by stamp
/// @return samples = 0, and zero error, where nothing was seen at rest
Visit measureVisit(const std::string& name, const Pose& target, const PoseStream& observations,
                   double end, double rest);

struct VisitComparison {
  std::vector<Visit> before, after;  ///< of the same targets, in the same order
  ErrorSummary summary_before, summary_after;
  std::vector<std::string> skipped;  ///< names that only one side has, or that nobody saw at rest
};

/// Pairs visits by name.
/// @throws InvalidInput  no visit in common, or a target that differs by more than 1e-6 m or rad
///         under the same name
VisitComparison compareVisits(const std::vector<Visit>& before, const std::vector<Visit>& after);

}  // namespace raven_correction
