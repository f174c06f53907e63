// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/claim.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr double kLeastSpread = 2.5;  // z over motions that a claim over typical motions needs, too
constexpr double kFewMotions = 1.6;   // z over motions of a cause that shows in few: about 3
constexpr double kLeastEvidence = 25.0;      // log likelihood ratio for it
constexpr double kCorrelatedSamples = 20.0;  // so many of motion capture count as one
constexpr double kQuiet = 1.5;               // residual over noise floor of a quiet recording [-]
constexpr int kSimulatedNumbers = 4000000;   // of the null distribution of z_typical, about
constexpr int kFewestLists = 2000, kMostLists = 40000;
constexpr std::uint64_t kNullSeed = 20140818;  // fixed: a threshold is the same in every run

/// Robust deviations, 1.4826 times the median distance from the median, of lists of n normal
/// numbers of deviation 1.
std::vector<double> robustDeviations(int n) {
  const int count = std::clamp(kSimulatedNumbers / n, kFewestLists, kMostLists);
  std::mt19937_64 engine(kNullSeed);
  std::normal_distribution<double> normal;
  std::vector<double> deviations, list(static_cast<std::size_t>(n));
  for (int i = 0; i < count; ++i) {
    for (double& value : list) value = normal(engine);
    const double middle = median(list);
    for (double& value : list) value = std::abs(value - middle);
    deviations.push_back(1.4826 * median(list));
  }
  return deviations;
}

/// The value that a variable of Student's distribution exceeds with that chance: the normal
/// quantile, by bisection, and Wallace's relation of the two. Source: Wallace 1959,
/// doi:10.1214/aoms/1177706089
double studentThreshold(double chance, int motions) {
  if (motions < 2) return std::numeric_limits<double>::infinity();
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double z = 0.5 * (low + high);
    (0.5 * std::erfc(z / M_SQRT2) > chance ? low : high) = z;
  }
  const double freedom = motions - 1;
  const double scaled = low * (8.0 * freedom + 3.0) / (8.0 * freedom + 1.0);
  return std::sqrt(freedom * std::expm1(scaled * scaled / freedom));
}

/// typicalThreshold() by these lists.
double thresholdOf(const std::vector<double>& deviations, double chance) {
  double low = 0.0, high = 1e6;
  for (int i = 0; i < 45; ++i) {  // to 3e-8
    const double z = 0.5 * (low + high);
    double beyond = 0.0;
    for (const double deviation : deviations) beyond += 0.5 * std::erfc(z * deviation / M_SQRT2);
    (beyond > chance * static_cast<double>(deviations.size()) ? low : high) = z;
  }
  return low;
}

}  // namespace

double typicalThreshold(double chance, int motions) {
  if (motions < 2) return std::numeric_limits<double>::infinity();
  return thresholdOf(robustDeviations(motions), chance);
}

ClaimRule::ClaimRule(const ResidualLayout& layout, double least_share, std::uint64_t seed)
    : layout_(layout),
      least_share_(least_share),
      seed_(seed),
      typical_(std::numeric_limits<double>::infinity()),
      student_(std::numeric_limits<double>::infinity()),
      samples_(Eigen::VectorXd::Zero(layout.motions)) {
  for (const ResidualBlock& block : layout.blocks)
    samples_(block.motion) += 1.0 / static_cast<double>(layout.channels.size());
}

void ClaimRule::setTried(std::size_t tried, double significance) {
  tried_ = std::max<std::size_t>(1, tried);
  deviations_ = robustDeviations(std::max(2, layout_.motions));
  significance_ = significance;
  claims_ = 0;
  setClaims(1);
}

void ClaimRule::setClaims(std::size_t claims) {
  claims = std::clamp<std::size_t>(claims, 1, std::max<std::size_t>(1, tried_));
  if (tried_ == 0 || claims == claims_) return;
  claims_ = claims;
  // Half for each of the two ways to earn a place.
  const double chance =
      0.5 * significance_ * static_cast<double>(claims) / static_cast<double>(tried_);
  typical_ = thresholdOf(deviations_, chance);
  student_ = studentThreshold(chance, layout_.motions);
}

LossComparison ClaimRule::compare(const Eigen::VectorXd& without, const Eigen::VectorXd& with,
                                  const Eigen::VectorXd& scales_of) const {
  const Eigen::VectorXd scales = channelScales(layout_, scales_of);
  return compareLosses(motionLosses(layout_, without, scales), motionLosses(layout_, with, scales),
                       seed_, 0);
}

LossComparison ClaimRule::compareWithInterval(const Eigen::VectorXd& without,
                                              const Eigen::VectorXd& with) const {
  const Eigen::VectorXd scales = channelScales(layout_, without);
  return compareLosses(motionLosses(layout_, without, scales), motionLosses(layout_, with, scales),
                       seed_);
}

double ClaimRule::logLikelihood(const Eigen::VectorXd& residual,
                                const Eigen::VectorXd& scales_of) const {
  const Eigen::VectorXd scales = channelScales(layout_, scales_of);
  double loss = 0.0;
  for (const ResidualBlock& block : layout_.blocks) {
    const int size = layout_.sizeOf(block);
    loss += huber(residual.segment(block.offset, size).norm() / scales(block.channel),
                  blockThreshold(size));
  }
  return -loss / kCorrelatedSamples;
}

double ClaimRule::evidence(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const {
  const Eigen::VectorXd scales = channelScales(layout_, without);
  const Eigen::ArrayXd gain =
      motionLosses(layout_, without, scales) - motionLosses(layout_, with, scales);
  return gain.isFinite().select(gain * samples_.array(), 0.0).sum() / kCorrelatedSamples;
}

bool ClaimRule::earns(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const {
  const LossComparison comparison = compare(without, with);
  if (comparison.share < least_share_) return false;
  if (comparison.z_mean > student_) return true;
  if (comparison.z_mean > kLeastSpread && comparison.z_typical > typical_) return true;
  return comparison.z_mean > kFewMotions && evidence(without, with) > kLeastEvidence &&
         isQuiet(without);
}

// The residual of most motions is no larger than their noise from frame to frame.
bool ClaimRule::isQuiet(const Eigen::VectorXd& residual) const {
  if (floor_.size() == 0) return false;
  const Eigen::VectorXd scale = channelScales(layout_, residual);
  return ((scale.array() <= kQuiet * floor_.array()) || (floor_.array() == 0.0)).all();
}

}  // namespace raven_correction
