// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/motion_capture.h"

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr unsigned kMinCameras = 2;  // to triangulate a marker

}  // namespace

const std::vector<MotionCaptureField>& motionCaptureFields() {
  using C = MotionCaptureConfig;
  static const std::vector<MotionCaptureField> fields{
      {"rate", &C::rate, 1.0, 1000.0},
      {"noise", &C::noise, 0.0, 0.01},
      {"rotation_noise", &C::rotation_noise, 0.0, 0.5},
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

MotionCapture::MotionCapture(const MotionCaptureConfig& config, std::uint64_t seed, double start)
    : config_(config), random_(seed) {
  for (const MotionCaptureField& field : motionCaptureFields()) {
    const double value = config.*field.value;
    if (!(value >= field.lower && value <= field.upper))
      throw InvalidInput(format("motion capture: %s = %g is outside [%g, %g]", field.key, value,
                                field.lower, field.upper));
  }
  for (Camera& camera : cameras_) camera.bias = gaussian(config_.camera_bias);
  restart(start);
}

void MotionCapture::restart(double start) {
  next_exposure_ = start;
  for (Camera& camera : cameras_) camera.blind_until = start;
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

/// Mean bias of the cameras that see the tool, less that of all: what calibration leaves is zero.
bool MotionCapture::cameraBias(double now, Eigen::Vector3d& bias, unsigned& visible) {
  Eigen::Vector3d seen = Eigen::Vector3d::Zero();
  Eigen::Vector3d all = Eigen::Vector3d::Zero();
  unsigned count = 0;
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    Camera& camera = cameras_[c];
    if (now >= camera.blind_until && happens(config_.camera_loss_rate / config_.rate))
      camera.blind_until = now + durationOf(config_.camera_loss_time);
    all += camera.bias;
    if (now < camera.blind_until) continue;
    seen += camera.bias;
    visible |= 1u << c;
    ++count;
  }
  if (count < kMinCameras) return false;
  bias = seen / count - all / static_cast<double>(cameras_.size());
  return true;
}

MocapFrame MotionCapture::capture(const Pose& X_base_tool) {
  MocapFrame frame;
  const double now = next_exposure_;
  frame.exposure = now;
  next_exposure_ = now + 1.0 / config_.rate;

  // Every random number is drawn in every frame, so one setting does not change the others' course.
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  const bool seen = cameraBias(now, bias, frame.visible_cameras);
  const Eigen::Vector3d position_noise = gaussian(config_.noise);
  const Eigen::Vector3d rotation_noise = gaussian(config_.rotation_noise);
  const double jitter = gaussian(config_.stamp_jitter).x();
  const bool dropped = happens(config_.drop_probability);
  const bool repeated = happens(config_.repeat_probability);
  if (now >= gap_until_ && happens(config_.gap_rate / config_.rate))
    gap_until_ = now + durationOf(config_.gap_time);
  if (now >= swap_until_ && happens(config_.swap_rate / config_.rate))
    swap_until_ = now + durationOf(config_.swap_time);

  if (!seen || dropped || now < gap_until_) return frame;
  if (repeated && last_) {
    frame.pose = last_;
    frame.repeated = true;
    return frame;
  }
  Pose X = X_base_tool;
  X.p += bias + position_noise;
  X.q = (X.q * expRotation(rotation_noise)).normalized();
  // The two finger markers taken for one another: the frame they span is turned by half a turn.
  if (now < swap_until_) X.q = X.q * Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  double stamp = now + config_.latency + jitter;
  if (last_ && stamp < last_->stamp) stamp = last_->stamp;  // a stream never runs backwards
  last_ = StampedPose{stamp, X};
  frame.pose = last_;
  return frame;
}

}  // namespace raven_correction
