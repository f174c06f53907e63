// SPDX-License-Identifier: BSD-3-Clause
// ./run bench prediction: one corrected pose, six means and six variances, against the same
// formulae written plainly with Eigen, in one run. Read the ratio, not the microseconds.
#include <benchmark/benchmark.h>

#include <random>

#include "raven_correction/regression/gp_predictor.h"

namespace {

using namespace raven_correction;  // NOLINT: a program of one file

/// Of the size of config/trainer.yaml: 1500 points, 24 features, 6 outputs, variance from 256.
const GpModel& model() {
  static const GpModel fitted = [] {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd x(1500, 24), y(1500, 6);
    for (double& value : x.reshaped()) value = normal(random);
    for (Eigen::Index k = 0; k < y.cols(); ++k)
      y.col(k) = x.col(k).array().sin() + 0.1 * x.col(k + 6).array();
    GpConfig config;
    config.backend = GpBackend::kExact;
    config.exact_variance_points = 256;
    config.max_hyper_points = 300;
    config.groups = {{0, 1, 2, 3, 4, 5}};
    return fitGp(x, y, config).model;
  }();
  return fitted;
}

void predictor(benchmark::State& state) {
  const GpPredictor gp(model());
  const auto workspace = gp.makeWorkspace();
  Eigen::VectorXd x = Eigen::VectorXd::Random(24);
  double mean[6], variance[6];
  for (auto _ : state) {
    x(0) = -x(0);
    gp.predict(x.data(), mean, variance, *workspace);
    benchmark::DoNotOptimize(mean);
    benchmark::DoNotOptimize(variance);
  }
}
BENCHMARK(predictor)->Unit(benchmark::kMicrosecond);

void plainEigen(benchmark::State& state) {
  const GpGroup& group = model().groups.front();
  const Eigen::MatrixXd scaled = group.length_scales.cwiseInverse().asDiagonal() * group.points;
  const Eigen::Index used = group.variance_factor.rows();
  Eigen::VectorXd x = Eigen::VectorXd::Random(24), mean, variance;
  for (auto _ : state) {
    x(0) = -x(0);
    const Eigen::ArrayXd r =
        std::sqrt(3.0) *
        (scaled.colwise() - x.cwiseQuotient(group.length_scales)).colwise().norm().array();
    const Eigen::VectorXd c = (1.0 + r) * (-r).exp();
    mean = group.weights.transpose() * c;
    const double explained =
        (group.variance_factor.triangularView<Eigen::Lower>() * c.head(used)).squaredNorm();
    variance = group.signal_variance * (1.0 - explained);
    benchmark::DoNotOptimize(mean);
    benchmark::DoNotOptimize(variance);
  }
}
BENCHMARK(plainEigen)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
