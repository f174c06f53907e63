// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/error_metrics.h"

#include <cmath>
#include <limits>

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

ErrorSummary::ErrorSummary()
    : coverage95(Eigen::Matrix<double, 6, 1>::Constant(std::numeric_limits<double>::quiet_NaN())),
      nlpd(coverage95) {}

namespace {

constexpr double kNormal95 = 1.959963984540054;  // 97.5 % quantile of the normal distribution

void summariseIntervals(const std::vector<PoseError>& errors, ErrorSummary& summary) {
  for (const PoseError& error : errors)
    if (!(error.deviation.minCoeff() > 0.0)) return;
  Eigen::Array<double, 6, 1> inside = Eigen::Array<double, 6, 1>::Zero(), density = inside;
  for (const PoseError& error : errors) {
    const Eigen::Array<double, 6, 1> z = error.residual.cwiseQuotient(error.deviation).array();
    inside += (z.abs() <= kNormal95).cast<double>();
    density += 0.5 * (std::log(2.0 * M_PI) + z.square()) + error.deviation.array().log();
  }
  summary.coverage95 = (inside / static_cast<double>(errors.size())).matrix();
  summary.nlpd = (density / static_cast<double>(errors.size())).matrix();
}

}  // namespace

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
  summariseIntervals(errors, summary);
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
  sum.coverage95.setZero();
  sum.nlpd.setZero();
  for (const ErrorSummary& s : summaries) {  // one without deviations makes the mean NaN
    sum.coverage95 += s.coverage95;
    sum.nlpd += s.nlpd;
  }
  const double scale = 1.0 / static_cast<double>(summaries.size());
  sum.mean_abs *= scale;
  sum.std *= scale;
  sum.position_norm *= scale;
  sum.angle_norm *= scale;
  sum.position_median *= scale;
  sum.position_p95 *= scale;
  sum.position_norm_paper *= scale;
  sum.angle_mean *= scale;
  sum.coverage95 *= scale;
  sum.nlpd *= scale;
  return sum;
}

}  // namespace raven_correction
