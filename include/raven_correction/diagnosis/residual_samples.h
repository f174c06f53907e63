// SPDX-License-Identifier: BSD-3-Clause
// The residual of a recording before and after its diagnosis, sample by sample, with what it may
// depend on: what figures are drawn from. How much of it depends on what is dependence.h.
#pragma once

#include <cstddef>
#include <vector>

#include "raven_correction/diagnosis/residual.h"

namespace raven_correction {

/// n samples, one column each. What a recording has not got has no rows.
struct ResidualSamples {
  std::vector<double> stamp;  ///< since the first of them [s]
  std::vector<int> motion;
  Eigen::MatrixXd position;  ///< 3 x n, measured tool in base [m]; joint data: no rows
  Eigen::MatrixXd velocity;  ///< 3 x n, of the simulated tool in base [m/s]; joint data: no rows
  Eigen::MatrixXd joints;    ///< simulated [rad or m]
  Eigen::MatrixXd speed;     ///< of them [rad/s or m/s]
  Eigen::MatrixXd load;      ///< gravity on each [Nm or N]; without masses: no rows

  struct Residual {
    /// 6 x n: position in base [m], rotation vector in the frame of the simulated tool [rad]; joint
    /// data: no rows.
    Eigen::MatrixXd tool;
    /// What each joint would have to be wrong by to make the same error of the tool, see
    /// projectToJoints(); joint data: the residual itself [rad or m].
    Eigen::MatrixXd joints;
  };
  Residual before, aligned, after;  ///< aligned: may be empty

  std::size_t size() const { return stamp.size(); }
};

/// A residual vector with what the simulation says that left it; both empty: there is none.
struct SimulatedResidual {
  Eigen::VectorXd residual;
  SimulatedSamples simulated;
};

/// @param before   its joints are those that the figures are drawn against
/// @param aligned  may be empty
/// @param most     about so many samples, evenly spread over every motion
ResidualSamples residualSamples(const Recording& recording, const ResidualLayout& layout,
                                const SimulatedResidual& before, const SimulatedResidual& aligned,
                                const SimulatedResidual& after, std::size_t most = 4000);

/// The joint error that explains an error of the tool best, damped so that a posture in which a
/// joint hardly moves the tool does not make it large:
///
///   minimise |W (J dq - e)|^2 + (damping)^2 |U dq|^2,  W weighs 1 rad as 0.05 m, U 1 rad as 0.1 m
///
/// @param jacobian  of the tool point
/// @param error     displacement [m], rotation vector [rad], both in base
/// @return [rad or m]
/// Source: Nakamura, Hanafusa 1986, doi:10.1115/1.3143764
Eigen::VectorXd projectToJoints(const KinematicChain& robot, const Jacobian& jacobian,
                                const Eigen::Matrix<double, 6, 1>& error);

}  // namespace raven_correction
