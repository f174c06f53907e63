// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/error_samples.h"

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

ErrorSeries& seriesOf(const TableOneRow& row, std::vector<ErrorSeries>& all) {
  for (ErrorSeries& series : all)
    if (series.configuration == row.configuration && series.method == row.method &&
        series.clean == row.clean)
      return series;
  all.emplace_back();
  all.back().configuration = row.configuration;
  all.back().method = row.method;
  all.back().clean = row.clean;
  return all.back();
}

}  // namespace

void append(const std::vector<PoseError>& errors, ErrorSeries& series) {
  for (const PoseError& error : errors) {
    series.components.push_back(error.components);
    series.position.push_back(error.components.head<3>().norm());
    series.angle.push_back(error.angle);
    if ((error.deviation.array() > 0.0).all())
      series.standardised.emplace_back(error.residual.cwiseQuotient(error.deviation));
  }
}

TableOneObserver ErrorSamples::observer() {
  return [this](const TableOneRow& row, const std::vector<TestState>& /*states*/,
                const std::vector<PoseError>& errors) { append(errors, seriesOf(row, series_)); };
}

const ErrorSeries& ErrorSamples::find(const std::string& configuration, Method method,
                                      bool clean) const {
  for (const ErrorSeries& series : series_)
    if (series.configuration == configuration && series.method == method && series.clean == clean)
      return series;
  throw InvalidInput(format("no errors of %s, %s, %s", configuration.c_str(), methodName(method),
                            clean ? "clean" : "dirty"));
}

CoverageCurve coverageOf(const std::vector<Eigen::Matrix<double, 6, 1>>& standardised) {
  CoverageCurve curve;
  if (standardised.empty()) return curve;
  for (int percent = 5; percent <= 95; percent += 5) curve.nominal.push_back(0.01 * percent);
  curve.nominal.push_back(0.99);
  curve.observed.setZero(static_cast<Eigen::Index>(curve.nominal.size()), 6);
  for (std::size_t k = 0; k < curve.nominal.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    // A value is inside the central interval of probability p if erf(|z| / sqrt 2) <= p.
    for (const Eigen::Matrix<double, 6, 1>& z : standardised)
      for (Eigen::Index v = 0; v < 6; ++v)
        if (std::erf(std::abs(z(v)) / std::sqrt(2.0)) <= curve.nominal[k])
          curve.observed(row, v) += 1.0;
  }
  curve.observed /= static_cast<double>(standardised.size());
  return curve;
}

}  // namespace raven_correction
