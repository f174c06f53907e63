// SPDX-License-Identifier: BSD-3-Clause
// Minimum of a smooth criterion in a box: from afar by L-BFGS-B, and near an optimum of a similar
// criterion by a quasi-Newton search that starts from its curvature. What the criterion is of, is
// hyperparameters.cpp.
#pragma once

#include <Eigen/Core>
#include <exception>
#include <functional>
#include <limits>
#include <string>

namespace raven_correction {

/// A criterion to be minimised, remembering the best point it has seen.
class Objective {
 public:
  /// Value at x; the gradient is written. Not finite where there is none.
  using Criterion = std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& gradient)>;
  /// @param evaluated  called after every evaluation, unless it is empty; what it throws ends a
  ///        search, and is thrown by it
  explicit Objective(Criterion criterion, std::function<void()> evaluated = {});

  /// As the criterion; where that is not finite a large value, which makes a line search turn back.
  double operator()(const Eigen::VectorXd& x, Eigen::VectorXd& gradient);

  double best_value = std::numeric_limits<double>::infinity();
  Eigen::VectorXd best;
  int evaluations = 0;
  std::exception_ptr interruption;  ///< what `evaluated` has thrown; null: nothing

 private:
  void tell();

  Criterion criterion_;
  std::function<void()> evaluated_;
};

struct Box {
  Eigen::VectorXd lower, upper;
};

struct SearchLimits {
  int max_iterations = 200;  ///< of searchBox(): per attempt, of which there are at most three
  double tolerance = 2e-7;   ///< decrease of the criterion that is not worth another step
};

struct SearchEnd {
  bool converged = false;
  std::string message;
  int iterations = 0;
};

/// L-BFGS-B from x; the point found is objective.best.
SearchEnd searchBox(Objective& objective, Eigen::VectorXd x, const Box& box,
                    const SearchLimits& limits);

/// Second derivatives at x by differences of gradients, with the absolute values of its
/// eigenvalues: where the criterion bends downwards, as steep a valley. Costs x.size() + 1
/// evaluations.
/// @return p x p, positive definite
Eigen::MatrixXd curvatureAt(Objective& objective, const Eigen::VectorXd& x);

/// Quasi-Newton search from x with the curvature to begin with: few evaluations where the optimum
/// is near. Damped BFGS; parameters that a bound holds rest. Ends when the decrease that the
/// curvature promises is below the tolerance. Source: Nocedal, Wright 2006, Numerical optimization,
/// procedure 18.2
/// @param curvature  p x p, positive definite
SearchEnd refineInBox(Objective& objective, Eigen::VectorXd x, Eigen::MatrixXd curvature,
                      const Box& box, const SearchLimits& limits);

}  // namespace raven_correction
