// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/motion_capture.h"

#include <cmath>
#include <utility>

#include "raven_correction/error.h"

namespace raven_correction {

const std::vector<MotionCaptureField>& motionCaptureFields() {
  using C = MotionCaptureConfig;
  static const std::vector<MotionCaptureField> fields{
      {"rate", &C::rate, 1.0, 1000.0},
      {"noise", &C::noise, 0.0, 0.01},
      {"camera_bias", &C::camera_bias, 0.0, 0.05},
      {"camera_loss_rate", &C::camera_loss_rate, 0.0, 100.0},
      {"camera_loss_time", &C::camera_loss_time, 0.0, 100.0},
      {"repeat_probability", &C::repeat_probability, 0.0, 0.9},
      {"drop_probability", &C::drop_probability, 0.0, 0.9},
      {"gap_rate", &C::gap_rate, 0.0, 10.0},
      {"gap_time", &C::gap_time, 0.0, 10.0},
      {"swap_rate", &C::swap_rate, 0.0, 10.0},
      {"swap_time", &C::swap_time, 0.0, 10.0},
      {"stamp_jitter", &C::stamp_jitter, 0.0, 0.1},
      {"latency", &C::latency, 0.0, 1.0}};
  return fields;
}

const std::vector<CameraRigField>& cameraRigFields() {
  using C = CameraRigConfig;
  static const std::vector<CameraRigField> fields{{"distance", &C::distance, 0.3, 10.0},
                                                  {"arc", &C::arc, 0.0, 6.28},
                                                  {"azimuth", &C::azimuth, -6.3, 6.3},
                                                  {"elevation", &C::elevation, -1.5, 1.5},
                                                  {"view", &C::view, 0.01, 1.5},
                                                  {"led_angle", &C::led_angle, 0.01, 3.15},
                                                  {"shaft_radius", &C::shaft_radius, 0.0, 0.1}};
  return fields;
}

MotionCapture::MotionCapture(const MotionCaptureConfig& config, std::uint64_t seed, double start)
    : config_(config), random_(seed), rig_(config.rig, config.camera_bias, seed ^ 0x9e3779b9u) {
  for (const MotionCaptureField& field : motionCaptureFields()) {
    const double value = config.*field.value;
    if (!(value >= field.lower && value <= field.upper))
      throw InvalidInput(format("motion capture: %s = %g is outside [%g, %g]", field.key, value,
                                field.lower, field.upper));
  }
  restart(start);
}

void MotionCapture::restart(double start) {
  next_exposure_ = start;
  blind_until_.fill(start);
  gap_until_ = start;
  swap_until_ = start;
  last_.reset();
}

bool MotionCapture::happens(double probability) {
  return std::uniform_real_distribution<double>(0.0, 1.0)(random_) < probability;
}

double MotionCapture::durationOf(double mean) {
  return mean > 0.0 ? std::exponential_distribution<double>(1.0 / mean)(random_) : 0.0;
}

Eigen::Vector3d MotionCapture::gaussian(double deviation) {
  std::normal_distribution<double> normal;
  const double x = normal(random_);
  const double y = normal(random_);
  return deviation * Eigen::Vector3d(x, y, normal(random_));
}

/// Cameras that have lost sight by chance (bits); every camera is asked in every frame.
unsigned MotionCapture::blindCameras(double now) {
  unsigned blind = covered_;
  for (std::size_t c = 0; c < kCameras; ++c) {
    const bool lost = happens(config_.camera_loss_rate / config_.rate);
    if (lost && now >= blind_until_[c])
      blind_until_[c] = now + durationOf(config_.camera_loss_time);
    if (now < blind_until_[c]) blind |= 1u << c;
  }
  return blind;
}

MocapFrame MotionCapture::capture(const Pose& X_base_tool, const std::vector<Obstacle>& obstacles) {
  MocapFrame frame;
  const double now = next_exposure_;
  frame.exposure = now;
  next_exposure_ = now + 1.0 / config_.rate;

  const unsigned blind = blindCameras(now);
  const double jitter = gaussian(config_.stamp_jitter).x();
  const bool dropped = happens(config_.drop_probability);
  const bool repeated = happens(config_.repeat_probability);
  if (now >= gap_until_ && happens(config_.gap_rate / config_.rate))
    gap_until_ = now + durationOf(config_.gap_time);
  if (now >= swap_until_ && happens(config_.swap_rate / config_.rate)) {
    swap_until_ = now + durationOf(config_.swap_time);
    swap_first_ = static_cast<std::size_t>(random_() % kLeds);
  }

  frame.sight = rig_.sight(X_base_tool, obstacles);
  std::array<Eigen::Vector3d, kLeds> p_base_led;
  bool seen = true;
  for (std::size_t l = 0; l < kLeds; ++l) {
    frame.sight[l] &= ~blind;
    const auto point = rig_.triangulate(X_base_tool * CameraRig::ledsInTool()[l], frame.sight[l]);
    const Eigen::Vector3d noise = gaussian(config_.noise);  // drawn whether or not it is used
    seen = seen && point.has_value();
    if (point) p_base_led[l] = *point + noise;
  }
  if (!seen || dropped || now < gap_until_) return frame;
  if (repeated && last_) {
    frame.pose = last_;
    frame.repeated = true;
    return frame;
  }
  if (now < swap_until_) {
    std::swap(p_base_led[swap_first_], p_base_led[(swap_first_ + 1) % kLeds]);
    frame.swapped = true;
  }
  double stamp = now + config_.latency + jitter;
  if (last_ && stamp < last_->stamp) stamp = last_->stamp;  // a stream never runs backwards
  last_ = StampedPose{stamp, CameraRig::poseFromLeds(p_base_led)};
  frame.pose = last_;
  return frame;
}

}  // namespace raven_correction
