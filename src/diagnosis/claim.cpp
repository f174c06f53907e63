// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/claim.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raven_correction {
namespace {

constexpr double kLeastSpread = 2.5;  // z over motions that a claim over typical motions needs, too
constexpr double kFewMotions = 1.6;   // z over motions of a cause that shows in few: about 3
constexpr double kLeastEvidence = 25.0;      // log likelihood ratio for it, in independent samples
constexpr double kCorrelatedSamples = 20.0;  // so many of motion capture count as one
constexpr double kQuiet = 1.5;               // residual over noise floor of a quiet recording [-]

/// The value that a variable of Student's distribution exceeds with probability p: the normal
/// quantile, by bisection, and Wallace's relation of the two. Source: Wallace 1959,
/// doi:10.1214/aoms/1177706089
double studentQuantile(double p, double freedom) {
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double z = 0.5 * (low + high);
    (0.5 * std::erfc(z / std::sqrt(2.0)) > p ? low : high) = z;
  }
  const double scaled = low * (8.0 * freedom + 3.0) / (8.0 * freedom + 1.0);
  return std::sqrt(freedom * std::expm1(scaled * scaled / freedom));
}

}  // namespace

ClaimRule::ClaimRule(const ResidualLayout& layout, double least_share, std::uint64_t seed)
    : layout_(layout),
      least_share_(least_share),
      seed_(seed),
      threshold_(std::numeric_limits<double>::infinity()),
      samples_(Eigen::VectorXd::Zero(layout.motions)) {
  for (const ResidualBlock& block : layout.blocks)
    samples_(block.motion) += 1.0 / static_cast<double>(layout.channels.size());
}

void ClaimRule::setTried(std::size_t tried, double significance) {
  const double chance = significance / static_cast<double>(std::max<std::size_t>(1, tried));
  threshold_ = studentQuantile(chance, std::max(1, layout_.motions - 1));
}

LossComparison ClaimRule::compare(const Eigen::VectorXd& without, const Eigen::VectorXd& with,
                                  const Eigen::VectorXd& scales_of) const {
  const Eigen::VectorXd scales = channelScales(layout_, scales_of);
  return compareLosses(motionLosses(layout_, without, scales), motionLosses(layout_, with, scales),
                       seed_);
}

bool ClaimRule::earns(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const {
  const LossComparison comparison = compare(without, with);
  if (comparison.share < least_share_) return false;
  if (comparison.z_mean > kLeastSpread && comparison.z_typical > threshold_) return true;
  const Eigen::VectorXd scales = channelScales(layout_, without);
  const Eigen::ArrayXd gain =
      motionLosses(layout_, without, scales) - motionLosses(layout_, with, scales);
  const double evidence =
      gain.isFinite().select(gain * samples_.array(), 0.0).sum() / kCorrelatedSamples;
  return comparison.z_mean > kFewMotions && evidence > kLeastEvidence && isQuiet(without);
}

// The residual of most motions is no larger than their noise from frame to frame.
bool ClaimRule::isQuiet(const Eigen::VectorXd& residual) const {
  if (floor_.size() == 0) return false;
  const Eigen::VectorXd scale = channelScales(layout_, residual);
  return ((scale.array() <= kQuiet * floor_.array()) || (floor_.array() == 0.0)).all();
}

}  // namespace raven_correction
