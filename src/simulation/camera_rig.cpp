// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/camera_rig.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kFingerLength = 0.008;  // of the finger LEDs ahead of the gripper centre [m]
constexpr double kFingerSpread = 0.010;  // of each to its side [m]
constexpr double kShaftBehind = 0.025;   // the shaft ends this far behind the tool point [m]

/// Shortest distance between the segments a0-a1 and b0-b1 [m].
/// Source: Ericson 2005, Real-Time Collision Detection, section 5.1.9
double segmentDistance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                       const Eigen::Vector3d& b0, const Eigen::Vector3d& b1) noexcept {
  const Eigen::Vector3d u = a1 - a0;
  const Eigen::Vector3d v = b1 - b0;
  const Eigen::Vector3d w = a0 - b0;
  const double uu = std::max(u.squaredNorm(), 1e-18);
  const double vv = std::max(v.squaredNorm(), 1e-18);
  const double uv = u.dot(v);
  const double denominator = uu * vv - uv * uv;
  double s = 0.0;
  if (denominator > 1e-12 * uu * vv)
    s = std::clamp((uv * v.dot(w) - vv * u.dot(w)) / denominator, 0.0, 1.0);
  double t = (uv * s + v.dot(w)) / vv;
  if (t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((uv * t - u.dot(w)) / uu, 0.0, 1.0);
  }
  return (w + s * u - t * v).norm();
}

void requireRange(const char* name, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper))
    throw InvalidInput(format("cameras: %s = %g is outside [%g, %g]", name, value, lower, upper));
}

}  // namespace

Obstacle instrumentOf(const CameraRigConfig& rig, const Pose& X_base_tool) noexcept {
  return {rig.remote_centre, X_base_tool.p, rig.shaft_radius};
}

CameraRig::CameraRig(const CameraRigConfig& config, double bias, std::uint64_t seed)
    : config_(config) {
  requireRange("distance", config.distance, 0.3, 10.0);
  requireRange("arc", config.arc, 0.0, 6.28);
  requireRange("elevation", config.elevation, -1.5, 1.5);
  requireRange("view", config.view, 0.01, 1.5);
  requireRange("led_angle", config.led_angle, 0.01, 3.15);
  requireRange("shaft_radius", config.shaft_radius, 0.0, 0.1);
  requireRange("length of led_direction", config.led_direction.norm(), 1e-3, 1e3);
  config_.led_direction.normalize();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t c = 0; c < kCameras; ++c) {
    const double share = static_cast<double>(c) / (kCameras - 1) - 0.5;
    const double azimuth = config.azimuth + share * config.arc;
    const double level = std::cos(config.elevation);
    p_base_camera_[c] =
        config.centre + config.distance * Eigen::Vector3d(level * std::cos(azimuth),
                                                          level * std::sin(azimuth),
                                                          std::sin(config.elevation));
    for (int i = 0; i < 3; ++i) bias_[c](i) = bias * normal(random);
  }
  const auto shifted = triangulate(config_.centre, (1u << kCameras) - 1u);
  if (shifted) calibrated_ = *shifted - config_.centre;
}

const std::array<Eigen::Vector3d, kLeds>& CameraRig::ledsInTool() {
  static const std::array<Eigen::Vector3d, kLeds> leds{
      Eigen::Vector3d::Zero(), Eigen::Vector3d(kFingerLength, kFingerSpread, 0.0),
      Eigen::Vector3d(kFingerLength, -kFingerSpread, 0.0)};
  return leds;
}

Pose CameraRig::poseFromLeds(const std::array<Eigen::Vector3d, kLeds>& p_base_led) {
  const Eigen::Vector3d x = (0.5 * (p_base_led[1] + p_base_led[2]) - p_base_led[0]).normalized();
  const Eigen::Vector3d across = p_base_led[1] - p_base_led[2];
  const Eigen::Vector3d y = (across - across.dot(x) * x).normalized();
  Eigen::Matrix3d R;
  R << x, y, x.cross(y);
  return {p_base_led[0], Eigen::Quaterniond(R).normalized()};
}

LedSight CameraRig::sight(const Pose& X_base_tool,
                          const std::vector<Obstacle>& obstacles) const noexcept {
  const Eigen::Vector3d light = X_base_tool.q * config_.led_direction;
  const Eigen::Vector3d to_centre = config_.remote_centre - X_base_tool.p;
  const Eigen::Vector3d shaft_end =
      X_base_tool.p + std::min(1.0, kShaftBehind / std::max(to_centre.norm(), 1e-9)) * to_centre;
  LedSight sight{};
  for (std::size_t l = 0; l < kLeds; ++l) {
    const Eigen::Vector3d led = X_base_tool * ledsInTool()[l];
    for (std::size_t c = 0; c < kCameras; ++c) {
      const Eigen::Vector3d& camera = p_base_camera_[c];
      const Eigen::Vector3d to_camera = (camera - led).normalized();
      const Eigen::Vector3d axis = (camera - config_.centre).normalized();
      if (to_camera.dot(axis) < std::cos(config_.view)) continue;
      if (to_camera.dot(light) < std::cos(config_.led_angle)) continue;
      if (segmentDistance(led, camera, shaft_end, config_.remote_centre) < config_.shaft_radius)
        continue;
      const bool hidden =
          std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
            return segmentDistance(led, camera, obstacle.from, obstacle.to) < obstacle.radius;
          });
      if (!hidden) sight[l] |= 1u << c;
    }
  }
  return sight;
}

std::optional<Eigen::Vector3d> CameraRig::triangulate(const Eigen::Vector3d& p_base_led,
                                                      unsigned cameras) const noexcept {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d pulled = Eigen::Vector3d::Zero();
  int count = 0;
  for (std::size_t c = 0; c < kCameras; ++c) {
    if ((cameras & (1u << c)) == 0) continue;
    const Eigen::Vector3d d = (p_base_led - p_base_camera_[c]).normalized();
    const Eigen::Matrix3d P = Eigen::Matrix3d::Identity() - d * d.transpose();
    A += P;
    pulled += P * bias_[c];
    ++count;
  }
  if (count < 2) return std::nullopt;
  return p_base_led + A.inverse() * pulled - calibrated_;
}

}  // namespace raven_correction
