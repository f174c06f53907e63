// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis_panels.h"

#include "diagnosis_words.h"
#include "report_json.h"

namespace raven_correction {

std::vector<Side> sidesOf(const Verdict& verdict) {
  return {{verdict.figures.before, "before", kInkBefore, true},
          {verdict.figures.after, "after", kInkAfter, false}};
}

std::vector<double> rowOf(const Eigen::MatrixXd& values, Eigen::Index row, double scale) {
  std::vector<double> out;
  if (row >= values.rows()) return out;
  for (Eigen::Index i = 0; i < values.cols(); ++i) out.push_back(scale * values(row, i));
  return out;
}

JointUnit unitOfJoint(const Verdict& verdict, std::size_t joint) {
  if (!verdict.has_kinematics) return {1.0, jointUnit(verdict, joint)};
  if (verdict.prismatic[joint]) return {kMillimetre, "mm"};
  return {kDegree, "deg"};
}

std::vector<Panel*> pointers(std::vector<Panel>& panels, std::size_t first, std::size_t count) {
  std::vector<Panel*> out;
  for (std::size_t i = first; i < first + count; ++i) out.push_back(&panels[i]);
  return out;
}

}  // namespace raven_correction
