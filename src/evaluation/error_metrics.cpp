// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/error_metrics.h"

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

PoseError poseError(const Pose& predicted, const Pose& truth) {
  PoseError error;
  const Eigen::Vector3d offset = truth.p - predicted.p;
  const Eigen::Quaterniond turn = predicted.q.conjugate() * truth.q;
  error.components << offset, zyxAngles(turn.normalized().toRotationMatrix());
  error.position_in_tool = predicted.q.conjugate() * offset;
  error.angle = rotationAngle(predicted.q, truth.q);
  return error;
}

ErrorSummary summarise(const std::vector<PoseError>& errors) {
  ErrorSummary summary;
  summary.n = errors.size();
  if (errors.empty()) return summary;
  Eigen::Vector3d in_tool;
  std::vector<double> values(errors.size());
  const auto collect = [&](auto&& value) {
    for (std::size_t i = 0; i < errors.size(); ++i) values[i] = value(errors[i]);
  };
  for (Eigen::Index k = 0; k < 6; ++k) {
    collect([k](const PoseError& e) { return std::abs(e.components(k)); });
    summary.mean_abs(k) = mean(values);
    summary.std(k) = standardDeviation(values);
  }
  for (Eigen::Index k = 0; k < 3; ++k) {
    collect([k](const PoseError& e) { return std::abs(e.position_in_tool(k)); });
    in_tool(k) = mean(values);
  }
  summary.position_norm = summary.mean_abs.head<3>().norm();
  summary.angle_norm = summary.mean_abs.tail<3>().norm();
  summary.position_norm_paper = in_tool.norm();
  collect([](const PoseError& e) { return e.angle; });
  summary.angle_mean = mean(values);
  collect([](const PoseError& e) { return e.components.head<3>().norm(); });
  summary.position_median = median(values);
  summary.position_p95 = quantile(values, 0.95);
  return summary;
}

ErrorSummary meanOf(const std::vector<ErrorSummary>& summaries) {
  ErrorSummary sum;
  for (const ErrorSummary& s : summaries) {
    sum.n += s.n;
    sum.mean_abs += s.mean_abs;
    sum.std += s.std;
    sum.position_norm += s.position_norm;
    sum.angle_norm += s.angle_norm;
    sum.position_median += s.position_median;
    sum.position_p95 += s.position_p95;
    sum.position_norm_paper += s.position_norm_paper;
    sum.angle_mean += s.angle_mean;
  }
  if (summaries.empty()) return sum;
  const double scale = 1.0 / static_cast<double>(summaries.size());
  sum.mean_abs *= scale;
  sum.std *= scale;
  sum.position_norm *= scale;
  sum.angle_norm *= scale;
  sum.position_median *= scale;
  sum.position_p95 *= scale;
  sum.position_norm_paper *= scale;
  sum.angle_mean *= scale;
  return sum;
}

}  // namespace raven_correction
