// SPDX-License-Identifier: BSD-3-Clause
// What a motion-capture system reports of a tool: noisy, at its own rate, with cameras that lose
// sight, frames that repeat, and gaps. Poses go in and come out in `base` (already registered).
// Where the cameras put an LED is camera_rig.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/simulation/camera_rig.h"

namespace raven_correction {

/// Every probability is per frame; every duration is exponentially distributed about its mean.
struct MotionCaptureConfig {
  CameraRigConfig rig;
  double rate = 120.0;        ///< frames [Hz]
  double noise = 1e-4;        ///< of each LED, one standard deviation per axis [m]
  double camera_bias = 5e-4;  ///< standard deviation of a camera's constant error at the tool [m]
  double camera_loss_rate = 0.2;    ///< how often a camera loses sight by chance [1/s]
  double camera_loss_time = 0.2;    ///< for how long, mean [s]
  double repeat_probability = 0.0;  ///< a frame is reported again with the stamp of the last [-]
  double drop_probability = 0.0;    ///< a single frame is missing [-]
  double gap_rate = 0.0;            ///< how often the stream pauses [1/s]
  double gap_time = 0.1;            ///< for how long, mean [s]
  double swap_rate = 0.0;           ///< how often two LEDs are taken for one another [1/s]
  double swap_time = 0.05;          ///< for how long, mean [s]
  double stamp_jitter = 0.0;        ///< standard deviation of a stamp's error [s]
  double latency = 0.0;             ///< stamps are this much later than the exposure [s]
};

/// Every scalar of the configuration with its key in YAML and its range.
struct MotionCaptureField {
  const char* key;
  double MotionCaptureConfig::*value;
  double lower;
  double upper;
};
const std::vector<MotionCaptureField>& motionCaptureFields();
/// Every scalar of the rig likewise.
struct CameraRigField {
  const char* key;
  double CameraRigConfig::*value;
  double lower;
  double upper;
};
const std::vector<CameraRigField>& cameraRigFields();

/// One frame as it left the system.
struct MocapFrame {
  double exposure = 0.0;            ///< when the picture was taken [s]
  std::optional<StampedPose> pose;  ///< nothing when an LED was not seen or the frame was dropped
  LedSight sight{};                 ///< which cameras saw which LED
  bool repeated = false;            ///< the frame before, reported again
  bool swapped = false;             ///< two LEDs were taken for one another: the pose is wrong
};

/// Deterministic from its seed and the sequence of calls.
class MotionCapture {
 public:
  /// @throws InvalidInput  a value outside its range
  MotionCapture(const MotionCaptureConfig& config, std::uint64_t seed, double start = 0.0);

  /// Exposure of the next frame [s]: bring the arm there, then capture() it.
  double nextExposure() const noexcept { return next_exposure_; }
  /// Takes the frame at nextExposure() and moves on to the next.
  /// @param X_base_tool  where the tool is at that instant
  /// @param obstacles    other arms that may be in the way, at that instant
  MocapFrame capture(const Pose& X_base_tool, const std::vector<Obstacle>& obstacles = {});
  /// Covers cameras by hand (bit c), for tests and demonstrations.
  void coverCameras(unsigned cameras) noexcept { covered_ = cameras; }
  /// The next frame is at `start`, nothing is lost or swapped; the random state goes on.
  void restart(double start);
  const MotionCaptureConfig& config() const noexcept { return config_; }

 private:
  bool happens(double probability);
  double durationOf(double mean);
  Eigen::Vector3d gaussian(double deviation);
  unsigned blindCameras(double now);

  MotionCaptureConfig config_;
  std::mt19937_64 random_;
  CameraRig rig_;
  unsigned covered_ = 0;
  double next_exposure_ = 0.0;
  std::array<double, kCameras> blind_until_{};  // [s]
  double gap_until_ = 0.0;
  double swap_until_ = 0.0;
  std::size_t swap_first_ = 0;  // this LED and the next are taken for one another
  std::optional<StampedPose> last_;
};

}  // namespace raven_correction
