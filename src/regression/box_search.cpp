// SPDX-License-Identifier: BSD-3-Clause
#include "box_search.h"

#include <LBFGSB.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>
#include <vector>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kDifference = 0.1;       // of a parameter, to see a gradient change
constexpr double kLeastCurvature = 1e-4;  // of a direction in which nothing bends
constexpr double kLongestStep = 1.0;      // of one parameter
constexpr double kArmijo = 1e-4;          // share of the promised decrease that a step must keep
constexpr double kDamping = 0.2;          // share of the curvature along a step that stays at least
constexpr int kMostShortenings = 10;

// A step that does not decrease enough: the lowest point of the parabola through both values and
// the slope at the first.
double shorter(double step, double slope, double change) {
  return step * std::clamp(-0.5 * step * slope / (change - step * slope), 0.1, 0.5);
}

// One damped BFGS update for the step s, along which the gradient changed by y.
void update(Eigen::MatrixXd& H, const Eigen::VectorXd& s, Eigen::VectorXd y) {
  const Eigen::VectorXd Hs = H * s;
  const double sHs = s.dot(Hs);
  const double sy = s.dot(y);
  if (!(sHs > 0.0)) return;
  if (sy < kDamping * sHs) y += (kDamping * sHs - sy) / (sHs - sy) * (Hs - y);  // s.y as wanted
  H += y * y.transpose() / s.dot(y) - Hs * Hs.transpose() / sHs;
}

struct Direction {
  Eigen::VectorXd step;   // empty: the curvature gives none
  Eigen::VectorXd slope;  // gradient, 0 for parameters that a bound holds
};

// The quasi-Newton step of the parameters that no bound holds: a bound holds those that the
// gradient, or the step of the others through the curvature, would take out of the box.
Direction directionInBox(const Eigen::VectorXd& x, const Eigen::VectorXd& gradient,
                         const Eigen::MatrixXd& curvature, const Box& box) {
  std::vector<bool> held(std::size_t(x.size()), false);
  const auto leaves = [&](Eigen::Index i, double towards) {
    return (x(i) <= box.lower(i) && towards < 0.0) || (x(i) >= box.upper(i) && towards > 0.0);
  };
  Direction direction;
  direction.step = -gradient;
  for (bool again = true; again;) {
    again = false;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (held[std::size_t(i)] || !leaves(i, direction.step(i))) continue;
      held[std::size_t(i)] = again = true;
    }
    if (!again && direction.slope.size() > 0) break;
    Eigen::MatrixXd H = curvature;
    direction.slope = gradient;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (!held[std::size_t(i)]) continue;
      H.row(i).setZero();
      H.col(i).setZero();
      H(i, i) = 1.0;
      direction.slope(i) = 0.0;
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(H);
    direction.step.resize(0);
    if (factor.info() != Eigen::Success) return direction;
    direction.step = -factor.solve(direction.slope);
    again = true;
  }
  return direction;
}

}  // namespace

Objective::Objective(Criterion criterion, std::function<void()> evaluated)
    : criterion_(std::move(criterion)), evaluated_(std::move(evaluated)) {}

void Objective::tell() {
  if (!evaluated_) return;
  try {
    evaluated_();
  } catch (...) {
    interruption = std::current_exception();
    throw;
  }
}

double Objective::operator()(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
  ++evaluations;
  const double value = criterion_(x, gradient);
  tell();
  if (!std::isfinite(value)) {  // a line search shortens its step on a large value
    gradient.setZero(x.size());
    return 1e10;
  }
  if (value < best_value) {
    best_value = value;
    best = x;
  }
  return value;
}

SearchEnd searchBox(Objective& objective, Eigen::VectorXd x, const Box& box,
                    const SearchLimits& limits) {
  LBFGSpp::LBFGSBParam<double> param;
  param.m = 20;
  param.epsilon = 1e-6;
  param.epsilon_rel = 0.0;
  param.past = 4;
  param.delta = limits.tolerance;
  param.max_linesearch = 30;
  SearchEnd end;
  double previous = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < 3; ++attempt) {
    param.max_iterations = std::max(1, limits.max_iterations - end.iterations);
    try {
      LBFGSpp::LBFGSBSolver<double> solver(param);
      double value = 0.0;
      const int iterations = solver.minimize(objective, x, value, box.lower, box.upper);
      end.iterations += iterations;
      end.converged = iterations < param.max_iterations;
      end.message = end.converged
                        ? "converged"
                        : format("stopped after %d iterations, the limit", end.iterations);
      return end;
    } catch (const std::exception& error) {
      if (objective.interruption) throw;  // the search was ended from outside
      // The line search found no better point: numerically at the optimum, or a bad curvature
      // model. A fresh start from the best point tells which.
      end.message = std::string("line search ended: ") + error.what();
      if (objective.best.size() == 0) return end;
      end.converged = previous - objective.best_value < limits.tolerance;
      if (end.converged) return end;
      previous = objective.best_value;
      x = objective.best;
    }
  }
  return end;
}

Eigen::MatrixXd curvatureAt(Objective& objective, const Eigen::VectorXd& x) {
  const Eigen::Index p = x.size();
  Eigen::VectorXd here, there;
  objective(x, here);
  Eigen::MatrixXd H(p, p);
  for (Eigen::Index i = 0; i < p; ++i) {
    Eigen::VectorXd moved = x;
    moved(i) -= kDifference;
    objective(moved, there);
    H.col(i) = (here - there) / kDifference;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (H + H.transpose()));
  const Eigen::VectorXd values = eigen.eigenvalues().cwiseAbs().cwiseMax(kLeastCurvature);
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

SearchEnd refineInBox(Objective& objective, Eigen::VectorXd x, Eigen::MatrixXd curvature,
                      const Box& box, const SearchLimits& limits) {
  SearchEnd end;
  Eigen::VectorXd gradient;
  double value = objective(x, gradient);
  if (objective.best.size() == 0) {
    end.message = "the criterion has no value at the start";
    return end;
  }
  for (; end.iterations < limits.max_iterations; ++end.iterations) {
    const Direction direction = directionInBox(x, gradient, curvature, box);
    if (direction.step.size() == 0) {
      end.message = "the curvature is not positive definite";
      return end;
    }
    end.converged = -0.5 * direction.step.dot(direction.slope) < limits.tolerance;
    if (end.converged) {
      end.message = "converged";
      return end;
    }
    double step = std::min(1.0, kLongestStep / direction.step.cwiseAbs().maxCoeff());
    double next_value = 0.0;
    Eigen::VectorXd next, next_gradient;
    for (int shortenings = 0;; ++shortenings) {
      next = (x + step * direction.step).cwiseMax(box.lower).cwiseMin(box.upper);
      next_value = objective(next, next_gradient);
      const double promised = direction.slope.dot(next - x);
      if (promised < 0.0 && next_value <= value + kArmijo * promised) break;
      if (shortenings == kMostShortenings) {
        end.message = "line search ended: no decrease along the quasi-Newton direction";
        return end;
      }
      step = shorter(step, direction.step.dot(direction.slope), next_value - value);
    }
    update(curvature, next - x, next_gradient - gradient);
    x = std::move(next);
    value = next_value;
    gradient = std::move(next_gradient);
  }
  end.message = format("stopped after %d iterations, the limit", end.iterations);
  return end;
}

}  // namespace raven_correction
