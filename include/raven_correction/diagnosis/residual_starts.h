// SPDX-License-Identifier: BSD-3-Clause
// Where to start the fit of causes whose error surface has many valleys: the residual is searched
// for the period of a pulley and for the instant of a shift, by linear least squares, without any
// simulation. Other causes start from startingPoints() of hypothesis.h.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "raven_correction/diagnosis/hypothesis.h"

namespace raven_correction {

/// The residual with what the searches need beside it.
struct ResidualView {
  const Recording* recording = nullptr;
  const ResidualLayout* layout = nullptr;
  const RecordingSummary* summary = nullptr;
  const Eigen::VectorXd* residual = nullptr;
  const Eigen::MatrixXd* joints = nullptr;  ///< simulated, one column per block
  Eigen::VectorXd scales;                   ///< of the channels
};

/// Starts (A, N, phi) of a pulley's eccentricity: the `most` periods, apart from one another, at
/// which A sin(N q + phi) explains most.
/// @param sensitivity  derivative of the residual by an offset of this joint
std::vector<Eigen::VectorXd> periodicStarts(const ResidualView& view, int joint,
                                            const Eigen::VectorXd& sensitivity, std::size_t most);

/// Start (x, y, z, rx, ry, rz, t0) of a registration shift: the instant after which another
/// registration explains most.
/// @param sensitivity  derivative of the residual by the six of a base registration
std::vector<Eigen::VectorXd> shiftStarts(const ResidualView& view,
                                         const Eigen::MatrixXd& sensitivity);

}  // namespace raven_correction
