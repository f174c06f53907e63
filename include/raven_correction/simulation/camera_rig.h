// SPDX-License-Identifier: BSD-3-Clause
// Four cameras on an arc and three LEDs on the gripper: which camera sees which LED, and where the
// cameras that see it put it. Noise, rates and stamps are motion_capture.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

constexpr std::size_t kCameras = 4;
constexpr std::size_t kLeds = 3;  ///< gripper centre, finger 1, finger 2
/// Bit c of element l: camera c sees LED l.
using LedSight = std::array<unsigned, kLeds>;

struct CameraRigConfig {
  Eigen::Vector3d centre{-0.020, -0.058, -0.140};  ///< what all cameras look at, in `base` [m]
  double distance = 1.5;                           ///< of the cameras from the centre [m]
  double arc = 2.0943951;       ///< angle from the first to the last camera [rad]
  double azimuth = -1.5707963;  ///< of the middle of the arc about z of `base`, from x [rad]
  double elevation = 0.6;       ///< of the cameras above the x-y plane [rad]
  double view = 0.35;           ///< half angle of a camera's field of view [rad]
  /// Direction in which the LEDs shine, in the tool frame, and half angle of their light [rad].
  Eigen::Vector3d led_direction{-0.52, 0.02, 0.85};
  double led_angle = 1.3;
  /// The instrument's shaft hides what is behind it: from this point in `base` to the tool [m].
  Eigen::Vector3d remote_centre = Eigen::Vector3d::Zero();
  double shaft_radius = 0.004;  ///< [m]
};

/// A straight piece of another arm that may stand in the way, in `base` [m].
struct Obstacle {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  double radius = 0.0;
};
/// The instrument of an arm as others' cameras meet it: its shaft, from its remote centre to the
/// tool point. What is above the remote centre stands behind the field as the cameras see it.
/// @param rig  of that arm: remote_centre and shaft_radius
Obstacle instrumentOf(const CameraRigConfig& rig, const Pose& X_base_tool) noexcept;

/// Each camera sees an LED displaced by a constant bias b_c of its own (what calibration leaves).
/// An LED is put where the lines of sight pass it closest, with d_c the direction from camera to
/// LED:
///
///   p = p_true + inv(A) sum_c P_c b_c,   P_c = 1 - d_c d_c^T,   A = sum_c P_c
///
/// over the cameras that see it: at least two. So the point is constant while the same cameras see
/// it, and jumps when one of them loses or regains sight.
class CameraRig {
 public:
  /// @param bias   one standard deviation per axis of b_c at the tool [m], >= 0
  /// @throws InvalidInput  a distance or an angle out of range
  CameraRig(const CameraRigConfig& config, double bias, std::uint64_t seed);

  /// LEDs in the tool frame [m]; the tool point is the gripper centre.
  static const std::array<Eigen::Vector3d, kLeds>& ledsInTool();
  /// The tool pose that three LEDs span: origin in the first, x towards the middle of the fingers,
  /// y from finger 2 towards finger 1.
  static Pose poseFromLeds(const std::array<Eigen::Vector3d, kLeds>& p_base_led);

  const std::array<Eigen::Vector3d, kCameras>& cameras() const noexcept { return p_base_camera_; }
  /// By geometry: field of view, light cone, own shaft, obstacles.
  LedSight sight(const Pose& X_base_tool, const std::vector<Obstacle>& obstacles) const noexcept;
  /// Where the cameras of `cameras` (bits) put an LED; nothing for fewer than two.
  std::optional<Eigen::Vector3d> triangulate(const Eigen::Vector3d& p_base_led,
                                             unsigned cameras) const noexcept;

 private:
  CameraRigConfig config_;
  std::array<Eigen::Vector3d, kCameras> p_base_camera_;
  std::array<Eigen::Vector3d, kCameras> bias_;            // b_c [m]
  Eigen::Vector3d calibrated_ = Eigen::Vector3d::Zero();  // shift of the centre seen by all [m]
};

}  // namespace raven_correction
