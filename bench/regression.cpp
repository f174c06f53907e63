// SPDX-License-Identifier: BSD-3-Clause
// Inner parts of the regression engine: what scripts/bench_regression.py runs first, before it puts
// whole fits beside those of others. Rates are in flops (a multiplication and an addition are two),
// counted by the textbook formula.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <random>
#include <vector>

#include "raven_correction/memory.h"
#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/gp_predictor.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "raven_correction/regression/online_process.h"
#include "raven_correction/regression/posterior.h"

namespace {

using namespace raven_correction;  // NOLINT: a program of one file

Eigen::MatrixXd normalMatrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd matrix(rows, columns);
  for (double& value : matrix.reshaped()) value = normal(random);
  return matrix;
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double threadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double quantile(std::vector<double> values, double share) {
  const auto at = std::size_t(share * double(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
  return values[at];
}

/// Cholesky factor of order n against the rate of products of half that order, measured in turn.
void choleskyAgainstProduct(benchmark::State& state) {
  const Eigen::Index n = state.range(0), m = n / 2;
  const Eigen::MatrixXd scaled = 0.5 * normalMatrix(12, n, 1);
  const Eigen::MatrixXd a = normalMatrix(m, m, 2), b = normalMatrix(m, m, 3);
  Eigen::MatrixXd c(m, m), K;
  std::vector<double> product, cholesky, ratio;
  for (auto _ : state) {
    double start = now();
    multiply(Transpose::kNo, Transpose::kNo, m, m, m, 1.0, a.data(), m, b.data(), m, 0.0, c.data(),
             m);
    product.push_back(2.0 * double(m) * double(m) * double(m) / (now() - start) * 1e-9);
    kernelMatrixLower(KernelType::kMatern32, scaled, K, nullptr);
    K.diagonal().array() += 0.1;
    start = now();
    if (factorCholesky(n, K.data(), n) != 0) state.SkipWithError("not positive definite");
    cholesky.push_back(double(n) * double(n) * double(n) / 3.0 / (now() - start) * 1e-9);
    ratio.push_back(cholesky.back() / product.back());
  }
  state.counters["product_gflops"] = quantile(product, 0.5);
  state.counters["cholesky_gflops"] = quantile(cholesky, 0.5);
  state.counters["ratio"] = quantile(ratio, 0.5);
}
BENCHMARK(choleskyAgainstProduct)
    ->Arg(2000)
    ->Arg(8000)
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

/// The size that config/trainer.yaml makes: points, and how many of them give the variance.
constexpr Eigen::Index kDefaultRows = 1500, kDefaultVariance = 256;

/// A model of the corrector's kind, 24 features and 6 outputs, and 400 pairs more.
struct CorrectorModel {
  Eigen::MatrixXd x, y;
  GpModel model;
  CorrectorModel(Eigen::Index rows, Eigen::Index variance_rows)
      : x(normalMatrix(rows + 400, 24, 1)), y(x.rows(), 6) {
    for (Eigen::Index k = 0; k < y.cols(); ++k)
      y.col(k) = x.col(k).array().sin() + 0.1 * x.col(k + 6).array();
    GpGroup group;
    group.outputs = {0, 1, 2, 3, 4, 5};
    group.length_scales = Eigen::VectorXd::Constant(24, 6.0);
    group.signal_variance = Eigen::VectorXd::Ones(6);
    group.noise_variance = 0.02 * group.signal_variance;
    group.mean_weights = Eigen::MatrixXd::Zero(25, 6);
    conditionExact(x.topRows(rows).transpose(), y.topRows(rows), group, variance_rows);
    model.features = 24;
    model.outputs = 6;
    model.groups = {group};
  }
};
/// 100 pairs into that model, and the model that comes out, ready to be queried.
void add100Pairs(benchmark::State& state) {
  const Eigen::Index n = kDefaultRows;
  const CorrectorModel data(n, kDefaultVariance);
  const OnlineProcess before(data.model, data.x.topRows(n), data.y.topRows(n), GpBackend::kExact);
  std::vector<double> wall;
  for (auto _ : state) {
    state.PauseTiming();
    auto online = std::make_unique<OnlineProcess>(before);
    state.ResumeTiming();
    const double start = now();
    online->add(data.x.middleRows(n, 100), data.y.middleRows(n, 100));
    const GpPredictor predictor(online->model());
    wall.push_back(now() - start);
    benchmark::DoNotOptimize(&predictor);
    state.PauseTiming();
    online.reset();
    state.ResumeTiming();
  }
  state.counters["p50_ms"] = 1e3 * quantile(wall, 0.5);
  state.counters["best_ms"] = 1e3 * quantile(wall, 0.0);
}
BENCHMARK(add100Pairs)->Iterations(15)->Unit(benchmark::kMillisecond);

/// One query, six means and six variances, of a model of some points and some of them for the
/// variance: quantiles on the clock, and of the time in which this thread had a processor (on a
/// busy machine the two differ).
void oneQuery(benchmark::State& state) {
  const GpPredictor predictor(CorrectorModel(state.range(0), state.range(1)).model);
  const auto workspace = predictor.makeWorkspace();
  const Eigen::MatrixXd queries = normalMatrix(24, 256, 7);
  double mean[6], variance[6];
  std::vector<double> wall, busy;
  for (auto _ : state) {
    const double* const x = queries.col(Eigen::Index(wall.size() % 256)).data();
    const double start = now(), start_busy = threadTime();
    predictor.predict(x, mean, variance, *workspace);
    busy.push_back(threadTime() - start_busy);
    wall.push_back(now() - start);
    benchmark::DoNotOptimize(mean);
    benchmark::DoNotOptimize(variance);
  }
  state.counters["p50_us"] = 1e6 * quantile(wall, 0.5);
  state.counters["p99_us"] = 1e6 * quantile(wall, 0.99);
  state.counters["p50_busy_us"] = 1e6 * quantile(busy, 0.5);
  state.counters["p99_busy_us"] = 1e6 * quantile(busy, 0.99);
}
BENCHMARK(oneQuery)
    ->Args({kDefaultRows, kDefaultVariance})
    ->Args({2000, 256})
    ->Args({2500, 320})
    ->Iterations(20000)
    ->Unit(benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) {
  raven_correction::keepFreedMemory();  // as the trainer does
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
