// SPDX-License-Identifier: BSD-3-Clause
// Whether a jaw that closes holds a piece of foam: by where the tool really is, and how it is
// turned. Where the planner wants it is debridement_task.h, how the jaw moves gripper.h.
#pragma once

#include "raven_correction/geometry/pose.h"
#include "raven_correction/simulation/foam_fragment.h"

namespace raven_correction {

struct GraspConfig {
  double finger = 0.010;       ///< from the axis of the jaw to the tool point [m]
  double squeeze = 0.001;      ///< the foam may be this much wider than the jaw is open [m]
  double height = 0.003;       ///< centre of the foam from the tool point, along the approach [m]
  double along_pads = 0.0035;  ///< the same along the pads [m]
  double tilt = 0.35;          ///< of the approach from the vertical [rad]
};
/// @throws InvalidInput  a length that is not positive, or a tilt outside (0, pi/2)
void checkGrasp(const GraspConfig& config);

/// How a fragment lies in an open jaw. Tool frame: x the approach, y across the jaw, z along the
/// pads.
struct GraspFit {
  Eigen::Vector3d p_tool_fragment = Eigen::Vector3d::Zero();  ///< centre of the foam [m]
  double extent = 0.0;  ///< of its outline from above across the jaw [m]
  double tilt = 0.0;    ///< of the approach from straight down [rad]
  bool holds = false;
};
/// With opening a, outline an ellipse of axes L and W whose long one is turned by phi from the
/// direction across the jaw:
///
///   w = sqrt((L cos phi)^2 + (W sin phi)^2)
///   holds = |x| <= height, |z| <= along_pads, tilt <= its limit,
///           2 |y| + w <= 2 finger sin(a / 2) + squeeze
///
/// @param opening  of the jaw before it closed [rad]
GraspFit fitGrasp(const GraspConfig& config, const FragmentTruth& fragment,
                  const Pose& X_field_tool, double opening);

}  // namespace raven_correction
