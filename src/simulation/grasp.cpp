// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/grasp.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {

void checkGrasp(const GraspConfig& config) {
  if (!(config.finger > 0.0 && config.squeeze >= 0.0 && config.height > 0.0 &&
        config.along_pads > 0.0))
    throw InvalidInput(
        format("grasp: finger = %g m, height = %g m, along_pads = %g m must be > 0, squeeze = %g m "
               ">= 0",
               config.finger, config.height, config.along_pads, config.squeeze));
  if (!(config.tilt > 0.0 && config.tilt < M_PI_2))
    throw InvalidInput(format("grasp: tilt = %g rad is outside (0, pi/2)", config.tilt));
}

GraspFit fitGrasp(const GraspConfig& config, const FragmentTruth& fragment,
                  const Pose& X_field_tool, double opening) {
  GraspFit fit;
  fit.p_tool_fragment = X_field_tool.inverse() * fragment.p_field;
  const Eigen::Vector3d approach = X_field_tool.q * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d across = X_field_tool.q * Eigen::Vector3d::UnitY();
  fit.tilt = std::acos(std::clamp(-approach.z(), -1.0, 1.0));
  const double phi = std::atan2(across.y(), across.x()) - fragment.yaw;
  fit.extent = std::hypot(fragment.length * std::cos(phi), fragment.width * std::sin(phi));
  const double room = 2.0 * config.finger * std::sin(0.5 * std::max(opening, 0.0)) + config.squeeze;
  const Eigen::Vector3d off = fit.p_tool_fragment.cwiseAbs();
  fit.holds = off.x() <= config.height && off.z() <= config.along_pads &&
              2.0 * off.y() + fit.extent <= room && fit.tilt <= config.tilt;
  return fit;
}

}  // namespace raven_correction
