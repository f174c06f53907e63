// SPDX-License-Identifier: BSD-3-Clause
// The effect parameters that explain a recording best: robust non-linear least squares over whole
// motions, and what is needed to judge the answer. Which effects to try is selection.h.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "raven_correction/diagnosis/residual.h"

namespace raven_correction {

/// One parameter of one effect of a simulation.
struct ParameterHandle {
  std::string effect;  ///< name in the catalogue
  int index = 0;       ///< into Effect::parameters()
  /// The part of the parameter's range that makes sense for a recording.
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};
/// The same effect and index.
bool operator==(const ParameterHandle& a, const ParameterHandle& b) noexcept;

/// The parameter that a handle stands for, its range cut to that of the handle; the nominal one
/// where the simulation lacks the effect.
/// @throws InvalidInput  no such effect or index
EffectParameter parameterOf(const SimulationConfig& simulation, const ParameterHandle& handle);

/// The simulation with these values. Effects that it does not have are added.
/// @throws InvalidInput  a value outside its range
SimulationConfig withValues(const SimulationConfig& simulation,
                            const std::vector<ParameterHandle>& parameters,
                            const Eigen::VectorXd& values);

/// Derivative of the residuals by the parameters, by differences that are wide enough to see past
/// held set-points and plays.
/// @param residual  at `values`
/// @return layout.size x parameters; columns before `first` are left zero
Eigen::MatrixXd residualJacobian(const Recording& recording, const ResidualLayout& layout,
                                 const SimulationConfig& simulation,
                                 const std::vector<ParameterHandle>& parameters,
                                 const Eigen::VectorXd& values, const Eigen::VectorXd& residual,
                                 Eigen::Index first = 0);

/// H = sum w J'J and g = sum w J'r over the blocks of some motions, whitened by the channel scales,
/// with Huber's weights and channels that count equally.
struct NormalEquations {
  Eigen::MatrixXd H;  ///< p x p
  Eigen::VectorXd g;  ///< p
};
/// One for each motion. @param jacobian  layout.size x p, of the residuals
std::vector<NormalEquations> normalEquations(const ResidualLayout& layout,
                                             const Eigen::VectorXd& residual,
                                             const Eigen::MatrixXd& jacobian,
                                             const Eigen::VectorXd& scales);

struct EffectFitProblem {
  const Recording* recording = nullptr;
  const ResidualLayout* layout = nullptr;
  SimulationConfig simulation;  ///< everything else that is wrong with the robot
  std::vector<ParameterHandle> parameters;
  Eigen::VectorXd start;  ///< within the parameters' ranges
  /// The residual at `start` where it is known; may be empty.
  Eigen::VectorXd start_residual;
  Eigen::VectorXd scales;  ///< of the channels, see channelScales()
  std::vector<bool> use;   ///< one per motion: fitted to it; empty: all
  int max_iterations = 25;
  double tolerance = 1e-6;  ///< relative change of the cost at which a fit has converged [-]
  /// Derivatives of the first parameters that are known well enough and not computed again:
  /// layout.size rows; may be empty.
  Eigen::MatrixXd frozen;
  bool with_covariance = true;  ///< else EffectFit::covariance stays empty
};

struct EffectFit {
  Eigen::VectorXd values;
  Eigen::VectorXd residual;    ///< of all motions, at `values`
  Eigen::MatrixXd jacobian;    ///< of the residual, layout.size x p
  Eigen::MatrixXd covariance;  ///< of the values, see effectCovariance()
  bool converged = false;
  std::string message = "fitEffects() has not run";
  int iterations = 0;
};

/// Huber's loss of whitened blocks, bounds from the parameters' ranges.
/// @throws InvalidInput  sizes differ, or no motion to fit to
EffectFit fitEffects(const EffectFitProblem& problem);

/// Covariance of fitted values; samples of one motion share their error, so motions are what is
/// counted: the sandwich over motions. No variance is smaller than with independent samples.
/// @param fit  of the problem: its residual and Jacobian count
/// @return p x p; parameters that the data do not determine are as wide as their range
/// Source: Liang, Zeger 1986, doi:10.1093/biomet/73.1.13
Eigen::MatrixXd effectCovariance(const EffectFitProblem& problem, const EffectFit& fit);

}  // namespace raven_correction
