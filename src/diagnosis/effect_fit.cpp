// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/effect_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "parallel.h"
#include "raven_correction/error.h"
#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

/// Residuals and derivatives at the point that Ceres asks for: computed once for all blocks.
class Evaluation : public ceres::EvaluationCallback {
 public:
  Evaluation(const EffectFitProblem& problem, const Eigen::VectorXd& values)
      : problem_(problem), values_(values) {
    if (problem.start_residual.size() == 0) return;
    residual_ = problem.start_residual;
    residual_at_ = problem.start;
  }

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) final {
    if ((new_evaluation_point || residual_.size() == 0) && !isAt(residual_at_)) {
      const SimulationConfig here = withValues(problem_.simulation, problem_.parameters, values_);
      residual_at_ = values_;
      residual_ = residuals(*problem_.recording, *problem_.layout, here);
    }
    if (evaluate_jacobians && !isAt(jacobian_at_)) {
      jacobian_at_ = values_;
      jacobian_ = residualJacobian(*problem_.recording, *problem_.layout, problem_.simulation,
                                   problem_.parameters, values_, residual_, problem_.frozen.cols());
      if (problem_.frozen.cols() > 0) jacobian_.leftCols(problem_.frozen.cols()) = problem_.frozen;
    }
  }
  const Eigen::VectorXd& residual() const { return residual_; }
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }

 private:
  /// A fit ends at a point that Ceres has asked for already.
  bool isAt(const Eigen::VectorXd& point) const {
    return point.size() == values_.size() && point == values_;
  }

  const EffectFitProblem& problem_;
  const Eigen::VectorXd& values_;           // Ceres writes the point into it
  Eigen::VectorXd residual_, residual_at_;  // and its point
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd jacobian_at_;
};

/// One block of the residual vector, whitened.
class BlockCost : public ceres::CostFunction {
 public:
  BlockCost(const Evaluation& evaluation, Eigen::Index offset, int size, double scale,
            int parameters)
      : evaluation_(evaluation), offset_(offset), size_(size), scale_(scale) {
    set_num_residuals(size);
    mutable_parameter_block_sizes()->push_back(parameters);
  }
  bool Evaluate(double const* const* /*parameters*/, double* residual,
                double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd>(residual, size_) =
        evaluation_.residual().segment(offset_, size_) / scale_;
    if (jacobians && jacobians[0]) {
      const Eigen::MatrixXd& J = evaluation_.jacobian();
      const Eigen::Index p = J.cols();
      const double inverse = 1.0 / scale_;
      for (Eigen::Index c = 0; c < p; ++c)  // row by row, as Ceres wants it
        for (Eigen::Index r = 0; r < size_; ++r)
          jacobians[0][r * p + c] = J(offset_ + r, c) * inverse;
    }
    return true;
  }

 private:
  const Evaluation& evaluation_;
  Eigen::Index offset_;
  int size_;
  double scale_;
};

}  // namespace

bool operator==(const ParameterHandle& a, const ParameterHandle& b) noexcept {
  return a.effect == b.effect && a.index == b.index;
}

EffectParameter parameterOf(const SimulationConfig& simulation, const ParameterHandle& handle) {
  const Effect* effect = simulation.find(handle.effect);
  std::unique_ptr<Effect> nominal;
  if (!effect) {
    nominal = makeEffect(handle.effect, simulation.robot);
    effect = nominal.get();
  }
  if (handle.index < 0 || handle.index >= static_cast<int>(effect->parameters().size()))
    throw InvalidInput(
        format("effect %s has no parameter %d", handle.effect.c_str(), handle.index));
  EffectParameter parameter = effect->parameters()[static_cast<std::size_t>(handle.index)];
  parameter.lower = std::max(parameter.lower, handle.lower);
  parameter.upper = std::min(parameter.upper, handle.upper);
  return parameter;
}

SimulationConfig withValues(const SimulationConfig& simulation,
                            const std::vector<ParameterHandle>& parameters,
                            const Eigen::VectorXd& values) {
  std::map<std::string, std::unique_ptr<Effect>> changed;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    std::unique_ptr<Effect>& effect = changed[parameters[i].effect];
    if (!effect) {
      const Effect* const present = simulation.find(parameters[i].effect);
      effect = present ? present->clone() : makeEffect(parameters[i].effect, simulation.robot);
    }
    effect->setValue(parameters[i].index, values(static_cast<Eigen::Index>(i)));
  }
  SimulationConfig result = simulation;
  for (auto& entry : changed) result.set(std::move(entry.second));
  return result;
}

std::vector<NormalEquations> normalEquations(const ResidualLayout& layout,
                                             const Eigen::VectorXd& residual,
                                             const Eigen::MatrixXd& jacobian,
                                             const Eigen::VectorXd& scales) {
  const Eigen::Index p = jacobian.cols();
  std::vector<NormalEquations> all(static_cast<std::size_t>(layout.motions),
                                   {Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p)});
  // The rows of a motion are neighbours: one product for each.
  const Eigen::VectorXd weights = rowWeights(layout, residual, scales);
  std::vector<Eigen::Index> begin(all.size(), -1), end(all.size(), 0);
  for (const ResidualBlock& block : layout.blocks) {
    const auto m = static_cast<std::size_t>(block.motion);
    if (begin[m] < 0) begin[m] = block.offset;
    end[m] = block.offset + layout.sizeOf(block);
  }
  for (std::size_t m = 0; m < all.size(); ++m) {
    if (begin[m] < 0) continue;
    const Eigen::Index rows = end[m] - begin[m];
    const auto J = jacobian.middleRows(begin[m], rows);
    const Eigen::MatrixXd WJ = weights.segment(begin[m], rows).asDiagonal() * J;
    all[m].H.noalias() = WJ.transpose() * J;
    all[m].g.noalias() = WJ.transpose() * residual.segment(begin[m], rows);
  }
  return all;
}

Eigen::MatrixXd effectCovariance(const EffectFitProblem& problem, const EffectFit& fit) {
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  // The scales of what is left, not of what was there when the fit began.
  const Eigen::VectorXd scales = channelScales(*problem.layout, fit.residual, problem.use);
  const std::vector<NormalEquations> motions =
      normalEquations(*problem.layout, fit.residual, fit.jacobian, scales);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(p, p), meat = H;
  double n = 0.0;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    if (!isUsed(problem.use, static_cast<int>(m))) continue;
    H += motions[m].H;
    meat += motions[m].g * motions[m].g.transpose();
    n += 1.0;
  }
  // Parameters that the data do not determine get the width of their whole range.
  for (Eigen::Index i = 0; i < p; ++i) {
    const EffectParameter parameter =
        parameterOf(problem.simulation, problem.parameters[static_cast<std::size_t>(i)]);
    H(i, i) += 1.0 / std::pow(parameter.upper - parameter.lower, 2);
  }
  const Eigen::MatrixXd inverse = H.ldlt().solve(Eigen::MatrixXd::Identity(p, p));
  Eigen::MatrixXd covariance = inverse * meat * inverse * (n / std::max(1.0, n - 1.0));
  for (Eigen::Index i = 0; i < p; ++i)  // no motion pulls at what moves nothing: its range is left
    if (!(covariance(i, i) > 0.0)) covariance(i, i) = inverse(i, i);
  const Eigen::ArrayXd ratio =
      inverse.diagonal().array() / covariance.diagonal().array().max(1e-300);
  const Eigen::VectorXd grow = ratio.max(1.0).sqrt();
  return grow.asDiagonal() * covariance * grow.asDiagonal();
}

EffectFit fitEffects(const EffectFitProblem& problem) {
  const ResidualLayout& layout = *problem.layout;
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  if (problem.start.size() != p || problem.frozen.cols() > p ||
      (problem.start_residual.size() > 0 && problem.start_residual.size() != layout.size) ||
      (!problem.use.empty() && static_cast<int>(problem.use.size()) != layout.motions))
    throw InvalidInput(format("a fit of %d parameters to %d motions got %d values and %zu flags",
                              static_cast<int>(p), layout.motions,
                              static_cast<int>(problem.start.size()), problem.use.size()));
  EffectFit fit;
  fit.values = problem.start;
  Evaluation evaluation(problem, fit.values);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &evaluation;
  ceres::Problem least_squares(problem_options);
  const Eigen::VectorXd weights = channelWeights(layout);
  for (const ResidualBlock& block : layout.blocks) {
    if (!isUsed(problem.use, block.motion)) continue;
    const int size = layout.sizeOf(block);
    least_squares.AddResidualBlock(
        new BlockCost(evaluation, block.offset, size, problem.scales(block.channel),
                      static_cast<int>(p)),
        new ceres::ScaledLoss(new ceres::HuberLoss(blockThreshold(size)), weights(block.channel),
                              ceres::TAKE_OWNERSHIP),
        fit.values.data());
  }
  if (least_squares.NumResidualBlocks() == 0) throw InvalidInput("no motion to fit effects to");
  for (Eigen::Index i = 0; i < p; ++i) {
    const EffectParameter parameter =
        parameterOf(problem.simulation, problem.parameters[static_cast<std::size_t>(i)]);
    least_squares.SetParameterLowerBound(fit.values.data(), static_cast<int>(i), parameter.lower);
    least_squares.SetParameterUpperBound(fit.values.data(), static_cast<int>(i), parameter.upper);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.dense_linear_algebra_library_type = ceres::EIGEN;  // not a slow LAPACK
  options.max_num_iterations = problem.max_iterations;
  options.function_tolerance = problem.tolerance;
  // Steps stop at the bounds; a search along each of them costs more than it saves.
  options.max_num_line_search_step_size_iterations = 0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &least_squares, &summary);

  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  fit.message = summary.message;
  fit.iterations = static_cast<int>(summary.iterations.size());
  evaluation.PrepareForEvaluation(true, true);
  fit.residual = evaluation.residual();
  fit.jacobian = evaluation.jacobian();
  if (problem.with_covariance) fit.covariance = effectCovariance(problem, fit);
  return fit;
}

}  // namespace raven_correction
