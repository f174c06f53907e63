// SPDX-License-Identifier: BSD-3-Clause
// What the correction knows of a motion at one instant: the pose and, from the past, how it got
// there. One piece of code computes it in training, offline and live. How it becomes the features
// of the Gaussian process is features.h.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "raven_correction/geometry/stream.h"

namespace raven_correction {

enum class VelocityKind {
  kNone,     ///< pose only
  kCentral,  ///< five-point stencil of the paper; looks ahead, so it exists offline only
  kCausal,   ///< least-squares slope over the past
};
/// "none", "central", "causal".
/// @throws InvalidInput  for any other name
VelocityKind velocityFromName(const std::string& name);
const char* velocityName(VelocityKind kind) noexcept;

constexpr std::size_t kMaxLags = 4;

struct MotionOptions {
  VelocityKind velocity = VelocityKind::kCausal;
  double window = 0.1;            ///< duration of the causal slope, > 0 [s]
  std::vector<double> lags{0.0};  ///< each twist ends this long before the sample, >= 0 [s]
  double max_gap = 0.15;          ///< a longer interval starts a new motion [s]
};
/// @throws InvalidInput  an option is out of its range, or there are more than kMaxLags lags
void checkMotionOptions(const MotionOptions& options);
/// Number of twists in a Motion: lags of the causal kind, one of the central, none otherwise.
std::size_t twistCount(const MotionOptions& options) noexcept;

/// Pose and twists at one instant, in one frame.
struct Motion {
  Pose pose;
  std::array<Twist, kMaxLags> twists;  ///< the first twistCount() are set
  double step = 0.0;                   ///< since the sample before [s]; 0 for the first of a motion
};

/// Follows a stream of poses sample by sample, with bounded memory and without allocation. Twist k
/// is causalTwist() of the samples up to `lag_k` ago; where the motion is younger than that, zero.
/// Central velocity has no live form: it is computed as causal.
class MotionEstimator {
 public:
  explicit MotionEstimator(const MotionOptions& options);

  enum class Outcome {
    kAccepted,   ///< motion() is of this sample
    kRepeated,   ///< same stamp as the sample before: nothing new, motion() is unchanged
    kBackwards,  ///< stamp before the last one: refused, nothing changed
    kNotFinite,  ///< stamp or pose is not finite: refused, nothing changed
    kNotUnit,    ///< quaternion not of unit length: refused, nothing changed
  };
  Outcome push(double stamp, const Pose& pose) noexcept;
  /// Of the last accepted sample.
  const Motion& motion() const noexcept { return motion_; }
  /// Forgets everything: the next sample is the first of a motion.
  void reset() noexcept;

 private:
  void remember(const StampedPose& sample) noexcept;

  static constexpr std::size_t kCapacity = 1024;  ///< samples remembered
  MotionOptions options_;
  double thinning_ = 0.0;             ///< samples closer than this share one place [s]
  std::vector<StampedPose> samples_;  ///< room for 2 kCapacity; the first count_ are the history
  std::size_t count_ = 0;
  double last_stamp_ = 0.0;
  bool started_ = false;
  Motion motion_;
};

/// The motions of all samples of a recorded stream; kCentral looks ahead within each motion.
/// @param stream  stamps strictly increasing
std::vector<Motion> motionsOf(const PoseStream& stream, const MotionOptions& options);

}  // namespace raven_correction
