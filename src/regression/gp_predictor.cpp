// SPDX-License-Identifier: BSD-3-Clause
// Prediction from a learnt model, one query or many.
#include "raven_correction/regression/gp_predictor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raven_correction/error.h"
#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "simd_kernels.h"

namespace raven_correction {
namespace {

// max(0, x) that lets NaN through: a query that is not finite must not look certain.
double aboveZero(double x) noexcept { return x < 0.0 ? 0.0 : x; }

constexpr Eigen::Index kBlock = 1024;  // queries of one batch product
constexpr Eigen::Index kPoints = 64;   // side by side: read as one stream, not one per feature

void checkGroup(const GpGroup& group, int features, std::size_t index) {
  const Eigen::Index m = group.points.cols();
  const Eigen::Index q = Eigen::Index(group.outputs.size());
  const bool fits = group.length_scales.size() == features && group.points.rows() == features &&
                    m > 0 && q > 0 && group.signal_variance.size() == q &&
                    group.noise_variance.size() == q && group.weights.rows() == m &&
                    group.weights.cols() == q && group.mean_weights.rows() == 1 + features &&
                    group.mean_weights.cols() == q && group.variance_factor.rows() > 0 &&
                    group.variance_factor.rows() <= m &&
                    group.variance_factor.cols() == group.variance_factor.rows();
  if (!fits) throw InvalidInput(format("model: sizes in group %zu do not fit together", index));
  const bool finite = group.length_scales.allFinite() && group.points.allFinite() &&
                      group.signal_variance.allFinite() && group.noise_variance.allFinite() &&
                      group.weights.allFinite() && group.mean_weights.allFinite() &&
                      group.variance_factor.allFinite();
  if (!finite) throw InvalidInput(format("model: a value in group %zu is not finite", index));
  if (!(group.length_scales.minCoeff() > 0.0))
    throw InvalidInput(format("model: length scale %g in group %zu, must be > 0",
                              group.length_scales.minCoeff(), index));
}

// What a single query reads of one group, laid out in the order in which it is read.
struct QueryGroup {
  Eigen::VectorXd inverse_scales;  // d
  std::vector<double> blocks;      // scaled points: kPoints of them, feature by feature, and so on
  std::vector<double> panels;      // variance factor, see SimdKernels::squaredNormLower
};

Eigen::Index roundUp(Eigen::Index value, Eigen::Index to) { return (value + to - 1) / to * to; }

QueryGroup queryGroup(const GpGroup& group, const Eigen::MatrixXd& scaled) {
  const Eigen::Index m = scaled.cols(), d = scaled.rows();
  const Eigen::Index rows = simdKernels().panel_rows;
  QueryGroup query;
  query.inverse_scales = group.length_scales.cwiseInverse();
  query.blocks.assign(std::size_t(roundUp(m, kPoints) * d), 0.0);
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index f = 0; f < d; ++f)
      query.blocks[std::size_t((i / kPoints * d + f) * kPoints + i % kPoints)] = scaled(f, i);
  const Eigen::Index mv = group.variance_factor.rows();
  const Eigen::Index panels = roundUp(mv, rows) / rows;
  query.panels.assign(std::size_t(rows * rows * panels * (panels + 1) / 2), 0.0);
  double* to = query.panels.data();
  for (Eigen::Index first = 0; first < mv; first += rows)
    for (Eigen::Index column = 0; column < first + rows; ++column, to += rows)
      for (Eigen::Index i = std::max(first, column); i < std::min(first + rows, mv); ++i)
        to[i - first] = group.variance_factor(i, column);
  return query;
}

}  // namespace

class GpPredictor::Workspace {
 public:
  Eigen::VectorXd x;             // scaled query
  Eigen::VectorXd correlations;  // c, zero past its end up to a whole panel
  Eigen::VectorXd means;         // of the outputs of one group
};

struct GpPredictor::Impl {
  GpModel model;
  std::vector<Eigen::MatrixXd> scaled;  // points of each group in units of its length scales
  std::vector<QueryGroup> queries;
  Eigen::VectorXd prior_deviation;
  Eigen::Index largest = 0;  // points of the largest group
};

GpPredictor::GpPredictor(GpModel given) {
  auto impl = std::make_unique<Impl>();
  impl->model = std::move(given);
  const GpModel& model = impl->model;
  if (model.features <= 0 || model.outputs <= 0 || model.groups.empty())
    throw InvalidInput(format("model: %d features, %d outputs, %zu groups; none may be 0",
                              model.features, model.outputs, model.groups.size()));
  impl->prior_deviation.setZero(model.outputs);
  std::vector<int> uses(std::size_t(model.outputs), 0);
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    const GpGroup& group = model.groups[g];
    checkGroup(group, model.features, g);
    for (std::size_t k = 0; k < group.outputs.size(); ++k) {
      const int output = group.outputs[k];
      if (output < 0 || output >= model.outputs || ++uses[std::size_t(output)] > 1)
        throw InvalidInput(
            format("model: output %d of group %zu is out of range or repeated", output, g));
      impl->prior_deviation(output) = std::sqrt(group.signal_variance(Eigen::Index(k)));
    }
    impl->scaled.push_back(scalePoints(group.points, group.length_scales));
    impl->queries.push_back(queryGroup(group, impl->scaled.back()));
    impl->largest = std::max(impl->largest, group.points.cols());
  }
  if (std::count(uses.begin(), uses.end(), 1) != model.outputs)
    throw InvalidInput("model: some outputs are in no group");
  impl_ = std::move(impl);
}

GpPredictor::~GpPredictor() = default;
GpPredictor::GpPredictor(GpPredictor&&) noexcept = default;
GpPredictor& GpPredictor::operator=(GpPredictor&&) noexcept = default;

int GpPredictor::features() const noexcept { return impl_->model.features; }
int GpPredictor::outputs() const noexcept { return impl_->model.outputs; }
const Eigen::VectorXd& GpPredictor::priorDeviation() const noexcept {
  return impl_->prior_deviation;
}

std::shared_ptr<GpPredictor::Workspace> GpPredictor::makeWorkspace() const {
  auto workspace = std::make_shared<Workspace>();
  workspace->x.setZero(impl_->model.features);
  workspace->means.setZero(impl_->model.outputs);
  workspace->correlations.setZero(roundUp(impl_->largest, simdKernels().panel_rows));
  return workspace;
}

void GpPredictor::predict(const double* x, double* mean, double* variance,
                          Workspace& workspace) const noexcept {
  const SimdKernels& simd = simdKernels();
  const Eigen::Index d = impl_->model.features;
  const Eigen::Map<const Eigen::VectorXd> query(x, d);
  for (std::size_t g = 0; g < impl_->model.groups.size(); ++g) {
    const GpGroup& group = impl_->model.groups[g];
    const QueryGroup& layout = impl_->queries[g];
    const Eigen::Index m = group.points.cols();
    workspace.x = query.cwiseProduct(layout.inverse_scales);
    double* const c = workspace.correlations.data();
    for (Eigen::Index i = 0; i < m; i += kPoints)
      simd.correlations(int(group.kernel), d, std::min(kPoints, m - i),
                        layout.blocks.data() + i * d, kPoints, 1, workspace.x.data(), d, c + i,
                        nullptr, m);
    const Eigen::Index q = Eigen::Index(group.outputs.size());
    double* const means = workspace.means.data();  // negative: the product subtracts
    std::fill(means, means + q, 0.0);
    simd.subtractTransposed(m, q, 1, group.weights.data(), m, c, m, means, q);
    for (Eigen::Index k = 0; k < q; ++k)
      mean[group.outputs[std::size_t(k)]] =
          group.mean_weights(0, k) + query.dot(group.mean_weights.col(k).tail(d)) - means[k];
    if (variance == nullptr) continue;
    const Eigen::Index mv = group.variance_factor.rows();
    std::fill(c + mv, c + roundUp(mv, simd.panel_rows), 0.0);
    const double left = aboveZero(1.0 - simd.squaredNormLower(mv, layout.panels.data(), c));
    for (Eigen::Index k = 0; k < q; ++k)
      variance[group.outputs[std::size_t(k)]] = group.signal_variance(k) * left;
  }
}

void GpPredictor::predict(const Eigen::MatrixXd& x, Eigen::MatrixXd& mean,
                          Eigen::MatrixXd* variance) const {
  if (x.cols() != impl_->model.features)
    throw InvalidInput(
        format("queries have %td features, the model has %d", x.cols(), impl_->model.features));
  mean.resize(x.rows(), impl_->model.outputs);
  if (variance != nullptr) variance->resize(x.rows(), impl_->model.outputs);
  Eigen::MatrixXd correlations;
  Eigen::MatrixXd projected;
  for (Eigen::Index first = 0; first < x.rows(); first += kBlock) {
    const Eigen::Index count = std::min(kBlock, x.rows() - first);
    const Eigen::MatrixXd points = x.middleRows(first, count).transpose();
    for (std::size_t g = 0; g < impl_->model.groups.size(); ++g) {
      const GpGroup& group = impl_->model.groups[g];
      const Eigen::Index m = group.points.cols();
      kernelMatrix(group.kernel, impl_->scaled[g], scalePoints(points, group.length_scales),
                   correlations);
      Eigen::MatrixXd means = evaluateMean(group.mean_weights, points);
      multiply(Transpose::kYes, Transpose::kNo, count, means.cols(), m, 1.0, correlations.data(), m,
               group.weights.data(), m, 1.0, means.data(), count);
      Eigen::VectorXd remaining;
      if (variance != nullptr) {
        const Eigen::Index mv = group.variance_factor.rows();
        projected = correlations.topRows(mv);
        multiplyLower(Transpose::kNo, mv, count, group.variance_factor.data(), mv, projected.data(),
                      mv);
        remaining = (1.0 - projected.colwise().squaredNorm().transpose().array()).matrix();
        for (double& share : remaining) share = aboveZero(share);
      }
      for (std::size_t k = 0; k < group.outputs.size(); ++k) {
        mean.col(group.outputs[k]).segment(first, count) = means.col(Eigen::Index(k));
        if (variance != nullptr)
          variance->col(group.outputs[k]).segment(first, count) =
              group.signal_variance(Eigen::Index(k)) * remaining;
      }
    }
  }
}

}  // namespace raven_correction
