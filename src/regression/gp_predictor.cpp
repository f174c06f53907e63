// SPDX-License-Identifier: BSD-3-Clause
// Prediction from a learnt model, one query or many.
#include "raven_correction/regression/gp_predictor.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/kernel_matrix.h"

namespace raven_correction {
namespace {

// max(0, x) that lets NaN through: a query that is not finite must not look certain.
double aboveZero(double x) noexcept { return x < 0.0 ? 0.0 : x; }

constexpr Eigen::Index kBlock = 512;  // queries of one batch product

void checkGroup(const GpGroup& group, int features, std::size_t index) {
  const Eigen::Index m = group.points.cols();
  const Eigen::Index q = Eigen::Index(group.outputs.size());
  const bool fits = group.length_scales.size() == features && group.points.rows() == features &&
                    m > 0 && q > 0 && group.signal_variance.size() == q &&
                    group.noise_variance.size() == q && group.weights.rows() == m &&
                    group.weights.cols() == q && group.mean_weights.rows() == 1 + features &&
                    group.mean_weights.cols() == q && group.variance_factor.rows() == m &&
                    group.variance_factor.cols() == m;
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

}  // namespace

class GpPredictor::Workspace {
 public:
  Eigen::VectorXd x;             // scaled query
  Eigen::VectorXd correlations;  // c
  Eigen::VectorXd projected;     // T c
};

struct GpPredictor::Impl {
  GpModel model;
  std::vector<Eigen::MatrixXd> scaled;  // points of each group in units of its length scales
  Eigen::VectorXd prior_deviation;
  Eigen::Index largest = 0;  // points of the largest group
};

GpPredictor::GpPredictor(const GpModel& model) {
  if (model.features <= 0 || model.outputs <= 0 || model.groups.empty())
    throw InvalidInput(format("model: %d features, %d outputs, %zu groups; none may be 0",
                              model.features, model.outputs, model.groups.size()));
  auto impl = std::make_unique<Impl>();
  impl->model = model;
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
  workspace->correlations.setZero(impl_->largest);
  workspace->projected.setZero(impl_->largest);
  return workspace;
}

void GpPredictor::predict(const double* x, double* mean, double* variance,
                          Workspace& workspace) const noexcept {
  const Eigen::Index d = impl_->model.features;
  for (std::size_t g = 0; g < impl_->model.groups.size(); ++g) {
    const GpGroup& group = impl_->model.groups[g];
    const Eigen::MatrixXd& scaled = impl_->scaled[g];
    const Eigen::Index m = scaled.cols();
    for (Eigen::Index j = 0; j < d; ++j) workspace.x(j) = x[j] / group.length_scales(j);
    for (Eigen::Index i = 0; i < m; ++i)
      workspace.correlations(i) = correlation(group.kernel, (scaled.col(i) - workspace.x).norm());
    double explained = 0.0;
    if (variance != nullptr) {
      workspace.projected.head(m).setZero();
      for (Eigen::Index j = 0; j < m; ++j)
        workspace.projected.segment(j, m - j) +=
            workspace.correlations(j) * group.variance_factor.col(j).tail(m - j);
      explained = workspace.projected.head(m).squaredNorm();
    }
    for (std::size_t k = 0; k < group.outputs.size(); ++k) {
      const Eigen::Index column = Eigen::Index(k);
      double value = group.mean_weights(0, column);
      for (Eigen::Index j = 0; j < d; ++j) value += x[j] * group.mean_weights(1 + j, column);
      for (Eigen::Index i = 0; i < m; ++i)
        value += workspace.correlations(i) * group.weights(i, column);
      mean[group.outputs[k]] = value;
      if (variance != nullptr)
        variance[group.outputs[k]] = group.signal_variance(column) * aboveZero(1.0 - explained);
    }
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
      const Eigen::MatrixXd trend = evaluateMean(group.mean_weights, points);
      const Eigen::MatrixXd means = trend + correlations.transpose() * group.weights;
      Eigen::VectorXd remaining;
      if (variance != nullptr) {
        projected.resize(m, count);
        multiply(Transpose::kNo, Transpose::kNo, m, count, m, 1.0, group.variance_factor.data(), m,
                 correlations.data(), m, 0.0, projected.data(), m);
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
