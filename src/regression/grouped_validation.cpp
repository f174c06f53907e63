// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/regression/grouped_validation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "raven_correction/error.h"
#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/inducing_points.h"
#include "raven_correction/regression/kernel_matrix.h"

namespace raven_correction {
namespace {

constexpr double kNormalQuantile975 = 1.959963984540054;

/// At most `count` of the rows, chosen by seed.
std::vector<Eigen::Index> thin(const std::vector<Eigen::Index>& rows, Eigen::Index count,
                               std::uint64_t seed) {
  std::vector<Eigen::Index> thinned;
  for (const Eigen::Index i : sampleIndices(static_cast<Eigen::Index>(rows.size()), count, seed))
    thinned.push_back(rows[static_cast<std::size_t>(i)]);
  return thinned;
}

}  // namespace

GroupedValidation::GroupedValidation(const Options& options, const Eigen::MatrixXd& points,
                                     const Eigen::MatrixXd& targets, const std::vector<int>& groups)
    : options_(options) {
  if (points.cols() != targets.rows() ||
      points.cols() != static_cast<Eigen::Index>(groups.size()) ||
      points.rows() != static_cast<Eigen::Index>(options.blocks.size()))
    throw InvalidInput(
        format("grouped validation: %td points of %td features, %td targets, %zu "
               "groups and %zu blocks do not fit together",
               points.cols(), points.rows(), targets.rows(), groups.size(), options.blocks.size()));
  for (const int block : options.blocks)
    lengths_ = std::max(lengths_, static_cast<Eigen::Index>(block) + 1);

  const std::set<int> names(groups.begin(), groups.end());
  if (names.size() < 2)
    throw InvalidInput(
        format("grouped validation: %zu groups; at least two are needed, one to "
               "learn from and one to predict",
               names.size()));
  std::vector<int> order(names.begin(), names.end());
  std::mt19937_64 random(options.seed);
  std::shuffle(order.begin(), order.end(), random);
  const int folds = std::min(options.folds, static_cast<int>(order.size()));
  for (int fold = 0; fold < folds; ++fold) {
    std::set<int> predicted;
    for (std::size_t i = static_cast<std::size_t>(fold); i < order.size();
         i += static_cast<std::size_t>(folds))
      predicted.insert(order[i]);
    std::vector<Eigen::Index> learn, predict;
    for (std::size_t i = 0; i < groups.size(); ++i)
      (predicted.count(groups[i]) ? predict : learn).push_back(static_cast<Eigen::Index>(i));
    learn = thin(learn, options.max_rows, options.seed + static_cast<std::uint64_t>(fold));
    predict = thin(predict, options.max_rows, options.seed + static_cast<std::uint64_t>(fold));
    Fold entry;
    entry.learn = static_cast<Eigen::Index>(learn.size());
    learn.insert(learn.end(), predict.begin(), predict.end());
    entry.points = selectColumns(points, learn);
    entry.targets = selectRows(targets, learn);
    folds_.push_back(std::move(entry));
  }
}

bool GroupedValidation::condition(const Fold& fold, const Eigen::VectorXd& log_parameters,
                                  bool with_slope) {
  Eigen::VectorXd length_scales(fold.points.rows());
  for (Eigen::Index j = 0; j < length_scales.size(); ++j)
    length_scales(j) = std::exp(log_parameters(options_.blocks[static_cast<std::size_t>(j)]));
  const double rho = std::exp(log_parameters(lengths_));
  scaled_ = scalePoints(fold.points, length_scales);
  if (!scaled_.allFinite() || !std::isfinite(rho)) return false;
  kernelMatrixLower(options_.kernel, scaled_, C_, with_slope ? &G_ : nullptr);
  const Eigen::Index a = fold.learn, b = C_.rows() - a, q = fold.targets.cols();
  factor_ = C_.topLeftCorner(a, a);
  factor_.diagonal().array() += rho;
  if (factorCholesky(a, factor_.data(), a) != 0) return false;
  cross_ = C_.bottomLeftCorner(b, a);
  alpha_ = fold.targets.topRows(a);
  solveLower(Transpose::kNo, a, q, factor_.data(), a, alpha_.data(), a);
  solveLower(Transpose::kYes, a, q, factor_.data(), a, alpha_.data(), a);
  return true;
}

double GroupedValidation::addFold(const Fold& fold, double rho, Eigen::VectorXd* gradient) {
  const Eigen::Index a = fold.learn, b = cross_.rows(), q = alpha_.cols();
  Eigen::MatrixXd error = -fold.targets.bottomRows(b);
  multiply(Transpose::kNo, Transpose::kNo, b, q, a, 1.0, cross_.data(), b, alpha_.data(), a, 1.0,
           error.data(), b);
  const double weight = 1.0 / static_cast<double>(b * q * static_cast<Eigen::Index>(folds_.size()));
  const Eigen::ArrayXXd root = (error.array().square() + options_.delta * options_.delta).sqrt();
  const double value = weight * (root - options_.delta).sum();
  if (gradient == nullptr) return value;

  // dvalue = tr(W' dK_BA alpha) - tr(V' dK_AA alpha) with W = dvalue/de, V = K^-1 K_AB W.
  const Eigen::MatrixXd W = (weight * error.array() / root).matrix();
  Eigen::MatrixXd V(a, q);
  multiply(Transpose::kYes, Transpose::kNo, a, q, b, 1.0, cross_.data(), b, W.data(), b, 0.0,
           V.data(), a);
  solveLower(Transpose::kNo, a, q, factor_.data(), a, V.data(), a);
  solveLower(Transpose::kYes, a, q, factor_.data(), a, V.data(), a);
  (*gradient)(lengths_) -= rho * V.cwiseProduct(alpha_).sum();

  // Sum over pairs of P(i, j) (z_i - z_j)^2 for each feature, P = dvalue/dC o G: rows of B with
  // columns of A, and the lower triangle of A with itself.
  Eigen::MatrixXd cross = W * alpha_.transpose();
  cross.array() *= G_.bottomLeftCorner(b, a).array();
  Eigen::MatrixXd own = -(V * alpha_.transpose() + alpha_ * V.transpose());
  for (Eigen::Index j = 0; j < a; ++j) {
    own.col(j).tail(a - j).array() *= G_.col(j).segment(j, a - j).array();
    own.row(j).tail(a - j) = own.col(j).tail(a - j).transpose();
  }
  const Eigen::MatrixXd learnt = scaled_.leftCols(a).transpose();
  const Eigen::MatrixXd predicted = scaled_.rightCols(b).transpose();
  // `own` holds each unordered pair twice with half its weight each.
  const Eigen::MatrixXd own_learnt = own * learnt;
  const Eigen::MatrixXd cross_learnt = cross * learnt;
  const Eigen::VectorXd own_sums = own.rowwise().sum();
  const Eigen::VectorXd row_sums = cross.rowwise().sum();
  const Eigen::VectorXd column_sums = cross.colwise().sum();
  for (Eigen::Index j = 0; j < scaled_.rows(); ++j) {
    const double within =
        own_sums.dot(learnt.col(j).cwiseAbs2()) - learnt.col(j).dot(own_learnt.col(j));
    const double between = row_sums.dot(predicted.col(j).cwiseAbs2()) +
                           column_sums.dot(learnt.col(j).cwiseAbs2()) -
                           2.0 * predicted.col(j).dot(cross_learnt.col(j));
    (*gradient)(options_.blocks[static_cast<std::size_t>(j)]) += within + between;
  }
  return value;
}

double GroupedValidation::evaluate(const Eigen::VectorXd& log_parameters,
                                   Eigen::VectorXd* gradient) {
  if (gradient != nullptr) gradient->setZero(parameters());
  double value = 0.0;
  for (const Fold& fold : folds_) {
    if (!log_parameters.allFinite() || !condition(fold, log_parameters, gradient != nullptr))
      return std::numeric_limits<double>::infinity();
    value += addFold(fold, std::exp(log_parameters(lengths_)), gradient);
  }
  return value;
}

Eigen::VectorXd GroupedValidation::signalVariance(const Eigen::VectorXd& log_parameters) {
  const double rho = std::exp(log_parameters(lengths_));
  const Eigen::Index q = folds_.front().targets.cols();
  std::vector<std::vector<double>> ratios(static_cast<std::size_t>(q));
  for (const Fold& fold : folds_) {
    if (!condition(fold, log_parameters, false)) continue;
    const Eigen::Index a = fold.learn, b = cross_.rows();
    const Eigen::MatrixXd error = cross_ * alpha_ - fold.targets.bottomRows(b);
    Eigen::MatrixXd half = cross_.transpose();
    solveLower(Transpose::kNo, a, b, factor_.data(), a, half.data(), a);
    const Eigen::ArrayXd variance =
        (1.0 - half.colwise().squaredNorm().transpose().array()).max(0.0) + rho;
    for (Eigen::Index k = 0; k < q; ++k)
      for (Eigen::Index i = 0; i < b; ++i)
        ratios[static_cast<std::size_t>(k)].push_back(std::abs(error(i, k)) /
                                                      std::sqrt(variance(i)));
  }
  Eigen::VectorXd signal = Eigen::VectorXd::Ones(q);
  for (Eigen::Index k = 0; k < q; ++k) {
    std::vector<double>& list = ratios[static_cast<std::size_t>(k)];
    if (list.empty()) continue;
    const auto at = list.begin() + static_cast<std::ptrdiff_t>(0.95 * double(list.size() - 1));
    std::nth_element(list.begin(), at, list.end());
    const double deviation = *at / kNormalQuantile975;
    signal(k) = deviation * deviation;
  }
  return signal;
}

}  // namespace raven_correction
