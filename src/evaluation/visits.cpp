// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/visits.h"

#include <array>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

Visit measureVisit(const std::string& name, const Pose& target, const PoseStream& observations,
                   double end, double rest) {
  Visit visit;
  visit.name = name;
  visit.target = target;
  std::array<std::vector<double>, 6> components;
  std::array<std::vector<double>, 3> in_tool;
  std::vector<double> angles;
  for (const StampedPose& observation : observations) {
    if (observation.stamp < end - rest || observation.stamp > end) continue;
    if (!isFinite(observation.pose) || !hasUnitQuaternion(observation.pose)) continue;
    const PoseError error = poseError(observation.pose, target);
    for (std::size_t k = 0; k < 6; ++k)
      components[k].push_back(error.components(static_cast<Eigen::Index>(k)));
    for (std::size_t k = 0; k < 3; ++k)
      in_tool[k].push_back(error.position_in_tool(static_cast<Eigen::Index>(k)));
    angles.push_back(error.angle);
  }
  visit.samples = angles.size();
  if (angles.empty()) return visit;
  for (std::size_t k = 0; k < 6; ++k)
    visit.error.components(static_cast<Eigen::Index>(k)) = median(components[k]);
  for (std::size_t k = 0; k < 3; ++k)
    visit.error.position_in_tool(static_cast<Eigen::Index>(k)) = median(in_tool[k]);
  visit.error.angle = median(angles);
  return visit;
}

VisitComparison compareVisits(const std::vector<Visit>& before, const std::vector<Visit>& after) {
  VisitComparison comparison;
  std::vector<PoseError> errors_before, errors_after;
  for (const Visit& first : before) {
    const Visit* second = nullptr;
    for (const Visit& candidate : after)
      if (candidate.name == first.name) second = &candidate;
    if (second == nullptr || first.samples == 0 || second->samples == 0) {
      comparison.skipped.push_back(first.name);
      continue;
    }
    const PoseError difference = poseError(first.target, second->target);
    if (difference.components.head<3>().norm() > 1e-6 || difference.angle > 1e-6)
      throw InvalidInput(format(
          "target of %s differs by %.3f mm, %.3f deg between the two recordings; visit the same "
          "targets (same planner seed) twice",
          first.name.c_str(), 1e3 * difference.components.head<3>().norm(),
          difference.angle * 180.0 / 3.14159265358979323846));
    comparison.before.push_back(first);
    comparison.after.push_back(*second);
    errors_before.push_back(first.error);
    errors_after.push_back(second->error);
  }
  if (comparison.before.empty())
    throw InvalidInput(
        "no trajectory with a target, seen at rest, is in both recordings; record "
        "the same planner run (same seed and prefix) twice");
  comparison.summary_before = summarise(errors_before);
  comparison.summary_after = summarise(errors_after);
  return comparison;
}

}  // namespace raven_correction
