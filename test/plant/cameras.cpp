// SPDX-License-Identifier: BSD-3-Clause
#include "plant/cameras.h"

#include <algorithm>
#include <random>

namespace raven_correction::plant {
namespace {

constexpr double kStampGap = 1e-5;  // between two different stamps, at least [s]

/// Something that begins at random and lasts for an exponentially distributed while.
class Spell {
 public:
  Spell(double rate, double mean_time) : rate_(rate), mean_time_(mean_time) {}
  /// True while it lasts; `began` tells whether it began with this frame.
  bool lasts(double now, double since, std::mt19937_64& random, bool& began) {
    began = false;
    if (now < until_) return true;
    if (!(std::uniform_real_distribution<double>()(random) < rate_ * since)) return false;
    began = true;
    until_ = now + std::exponential_distribution<double>(1.0 / mean_time_)(random);
    return true;
  }

 private:
  double rate_;
  double mean_time_;
  double until_ = -1e300;
};

Eigen::Vector3d gaussian(double deviation, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  const double z = normal(random);
  return deviation * Eigen::Vector3d(x, y, z);
}

}  // namespace

CameraOptions cleanCameras(double noise, double orientation_noise) {
  CameraOptions options;
  options.noise = noise;
  options.orientation_noise = orientation_noise;
  options.stamp_jitter = 0.0;
  options.repeat_probability = 0.0;
  options.gap_rate = 0.0;
  options.jump_rate = 0.0;
  options.flip_rate = 0.0;
  return options;
}

PoseStream photograph(const PoseStream& perfect, const CameraOptions& options, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  Spell gap(options.gap_rate, options.gap_time);
  Spell blind(options.jump_rate, options.jump_time);
  Spell flipped(options.flip_rate, options.flip_time);
  Eigen::Vector3d jump = Eigen::Vector3d::Zero();
  Eigen::Quaterniond flip = Eigen::Quaterniond::Identity();
  PoseStream seen;
  for (std::size_t k = 0; k < perfect.size(); ++k) {
    const double now = perfect[k].stamp;
    const double since = k > 0 ? now - perfect[k - 1].stamp : 0.0;
    bool began = false;
    if (gap.lasts(now, since, random, began)) continue;
    StampedPose frame = perfect[k];
    frame.stamp += std::normal_distribution<double>()(random) * options.stamp_jitter;
    frame.pose.p += gaussian(options.noise, random);
    frame.pose.q *= expRotation(gaussian(options.orientation_noise, random));
    if (blind.lasts(now, since, random, began)) {
      if (began) jump = gaussian(options.jump_size, random);
      frame.pose.p += jump;
    }
    if (flipped.lasts(now, since, random, began)) {
      const double angle = 0.7 + 1.4 * uniform(random);  // 40 to 120 deg
      if (began) flip = expRotation(angle * gaussian(1.0, random).normalized());
      frame.pose.q *= flip;
    }
    frame.pose.q.normalize();
    if (!seen.empty()) {
      frame.stamp = std::max(frame.stamp, seen.back().stamp + kStampGap);
      if (uniform(random) < options.repeat_probability) frame = seen.back();
    }
    seen.push_back(frame);
  }
  return seen;
}

}  // namespace raven_correction::plant
