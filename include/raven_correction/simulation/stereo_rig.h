// SPDX-License-Identifier: BSD-3-Clause
// A stereo camera over the field, as a calibration would describe it: two cameras that look at the
// same point, with lenses and small misalignments. What it sees is stereo_renderer.h.
#pragma once

#include "raven_correction/geometry/pose.h"
#include "raven_correction/geometry/stereo_camera.h"

namespace raven_correction {

struct StereoRigConfig {
  int width = 640;          ///< of both images [px]
  int height = 480;         ///< [px]
  double focal = 1250.0;    ///< [px]
  double baseline = 0.06;   ///< [m]
  double distance = 0.30;   ///< from the middle between the cameras to what they look at [m]
  double tilt = 0.35;       ///< of the line of sight from the vertical [rad]
  double azimuth = -1.571;  ///< of the camera about z of the field, from x [rad]
  Eigen::Matrix<double, 5, 1> distortion_left{-0.21, 0.16, 7e-4, -5e-4, 0.0};  ///< plumb_bob [-]
  Eigen::Matrix<double, 5, 1> distortion_right{-0.19, 0.12, -4e-4, 6e-4, 0.0};
  double misalignment = 0.006;  ///< of each camera about its three axes, a typical angle [rad]
};

struct StereoRig {
  StereoCamera camera;
  Pose X_field_camera;  ///< of the left `rect` frame in the field, which is looked at
};

/// Both cameras are turned towards the origin of the field; the rectification turns the images back
/// to parallel, and moves them so that the origin stands in the middle of both.
/// @throws InvalidInput  a length or size that is not positive, |tilt| > 1.2, or see checkCamera()
StereoRig makeStereoRig(const StereoRigConfig& config);

}  // namespace raven_correction
