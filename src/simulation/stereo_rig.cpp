// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/stereo_rig.h"

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

/// @param side  -1 left, 1 right
PinholeCamera makeCamera(const StereoRigConfig& config, int side) {
  const double half = 0.5 * config.baseline;
  const double centre_u = 0.5 * (config.width - 1);
  const double centre_v = 0.5 * (config.height - 1);
  PinholeCamera camera;
  camera.width = config.width;
  camera.height = config.height;
  // No sensor is centred under its lens, and no two lenses are alike.
  camera.K << config.focal * (1.0 + 0.004 * side), 0.0, centre_u + 5.0 * side,  //
      0.0, config.focal * (1.0 + 0.003 * side), centre_v - 4.0 + 3.0 * side,    //
      0.0, 0.0, 1.0;
  camera.D = side < 0 ? config.distortion_left : config.distortion_right;
  const double m = config.misalignment;
  const Eigen::Vector3d turn = side < 0 ? Eigen::Vector3d(0.7 * m, 0.4 * m, -m)
                                        : Eigen::Vector3d(-0.5 * m, -0.6 * m, 0.8 * m);
  const Eigen::Vector3d inwards(0.0, -side * std::atan(half / config.distance), 0.0);
  camera.R = (expRotation(inwards) * expRotation(turn)).toRotationMatrix();
  camera.P << config.focal, 0.0, centre_u + side * config.focal * half / config.distance, 0.0,  //
      0.0, config.focal, centre_v, 0.0,                                                         //
      0.0, 0.0, 1.0, 0.0;
  if (side > 0) camera.P(0, 3) = -config.focal * config.baseline;
  return camera;
}

}  // namespace

StereoRig makeStereoRig(const StereoRigConfig& config) {
  for (const double positive : {config.focal, config.baseline, config.distance})
    if (!(positive > 0.0 && std::isfinite(positive)))
      throw InvalidInput(
          format("stereo rig: focal = %g px, baseline = %g m, distance = %g m, all "
                 "must be > 0",
                 config.focal, config.baseline, config.distance));
  if (!(std::abs(config.tilt) <= 1.2) || !std::isfinite(config.azimuth))
    throw InvalidInput(
        format("stereo rig: tilt = %g rad must be in [-1.2, 1.2], azimuth = %g rad "
               "finite; the cameras look down on the field",
               config.tilt, config.azimuth));
  StereoRig rig;
  rig.camera.left = makeCamera(config, -1);
  rig.camera.right = makeCamera(config, 1);
  checkStereoCamera(rig.camera);

  const Eigen::Vector3d towards(std::sin(config.tilt) * std::cos(config.azimuth),
                                std::sin(config.tilt) * std::sin(config.azimuth),
                                std::cos(config.tilt));  // from the field to the cameras
  Eigen::Matrix3d R_field_camera;
  R_field_camera.col(0) = Eigen::Vector3d(-std::sin(config.azimuth), std::cos(config.azimuth), 0.0);
  R_field_camera.col(2) = -towards;
  R_field_camera.col(1) = R_field_camera.col(2).cross(R_field_camera.col(0));
  rig.X_field_camera.q = Eigen::Quaterniond(R_field_camera).normalized();
  rig.X_field_camera.p = config.distance * towards - 0.5 * config.baseline * R_field_camera.col(0);
  return rig;
}

}  // namespace raven_correction
