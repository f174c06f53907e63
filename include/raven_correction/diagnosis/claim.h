// SPDX-License-Identifier: BSD-3-Clause
// When a gain on held-out motions is enough to claim a cause: the threshold, corrected for how many
// hypotheses were tried, and what a recording that is quiet otherwise allows. How large a gain is,
// is held_out.h; what is tried in which order, selection.h.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "raven_correction/diagnosis/held_out.h"

namespace raven_correction {

/// The z_typical (LossComparison) that a useless hypothesis exceeds with this probability, where
/// the differences of the n motions are independent, normal and of mean 0. The mean of normal
/// numbers is independent of their distances from one another, so with s the robust deviation of n
/// of them, and Q the upper tail of the normal distribution,
///
///   P(z_typical > t) = E[Q(t s)],
///
/// whose expectation is that over simulated lists (fixed seed), and which is solved for t by
/// bisection. For many motions it is the normal quantile; with ten of them s is often small, and
/// the tail far heavier than Student's.
/// @param chance  in (0, 0.5) [-]
/// @return infinity for fewer than two motions
double typicalThreshold(double chance, int motions);

/// Every claim has to pass this, of a new cause or of one that stays. Either it is a gain beyond
/// chance over motions; or, where nothing but noise is left of most motions, it explains far more
/// than noise could in a few of them: a limit that only the fastest motions reach.
class ClaimRule {
 public:
  /// @param layout       of the recording; referred to, so it has to outlive the rule
  /// @param least_share  of the held-out loss that a claim must gain [-]
  /// @param seed         of the bootstrap of compare()
  ClaimRule(const ResidualLayout& layout, double least_share, std::uint64_t seed);

  /// The gain must be beyond chance, after `tried` hypotheses. Until then no gain is enough.
  /// @param significance  of claiming anything where there is nothing, and the share of claims that
  ///                      may be false where there is something, both nominal, in (0, 0.5) [-]
  void setTried(std::size_t tried, double significance);

  /// So many claims are made at once: each may then be false with a chance of claims / tried times
  /// the significance. One alone is the correction of Bonferroni, and with many the share of false
  /// ones is meant to stay what it was. That share is nominal: the tests share motions and rivals,
  /// the third way to earn a place (earns()) has no such chance, causes are chosen in turn with the
  /// ones before in view, and the parts of a group count as one claim each and so relax what the
  /// others have to pass. How often claims are false is counted, see doc/diagnosis.md.
  /// Source: Benjamini and Hochberg 1995, doi:10.1111/j.2517-6161.1995.tb02031.x
  void setClaims(std::size_t claims);

  /// Noise from frame to frame, one per channel (noiseFloor()). Until then no recording is quiet.
  void setNoise(const Eigen::VectorXd& floor) { floor_ = floor; }

  /// How much better `with` explains the held-out motions than `without`, every channel in units of
  /// its spread in `scales_of`. Without the interval, which nothing is decided by.
  /// @param without, with, scales_of  residuals, layout.size each
  LossComparison compare(const Eigen::VectorXd& without, const Eigen::VectorXd& with,
                         const Eigen::VectorXd& scales_of) const;
  /// The same at the scales of `without`.
  LossComparison compare(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const {
    return compare(without, with, without);
  }
  /// With the interval of the share, too.
  LossComparison compareWithInterval(const Eigen::VectorXd& without,
                                     const Eigen::VectorXd& with) const;
  /// Log likelihood of residuals in units of their spread in `scales_of`, less that of none: minus
  /// the sum over all samples, channels and components of Huber's loss (half the square, for most),
  /// over 20, because about 20 samples of motion capture in a row say as much as one independent
  /// one
  /// [-].
  double logLikelihood(const Eigen::VectorXd& residual, const Eigen::VectorXd& scales_of) const;
  /// Whether that gain is enough to claim what `with` has and `without` has not. At least
  /// least_share of the loss, and then one of
  ///
  ///   mean     z_mean beyond the first threshold of setTried(): every motion gains alike, so that
  ///            few motions are enough
  ///   typical  z_mean > 2.5 and z_typical beyond the second: most motions gain, some of them much
  ///   few      z_mean > 1.6, the recording is quiet but for these (scale of `without` at most 1.5
  ///            of the noise, in every channel), and evidence above 25: the sum over motions of
  ///            (gain in mean loss) x (samples per channel) / 20, a log likelihood ratio in which
  ///            every sample counts once, however many numbers it has
  ///
  /// @param without, with  held-out residuals, layout.size each
  bool earns(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const;

 private:
  bool isQuiet(const Eigen::VectorXd& residual) const;
  double evidence(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const;

  const ResidualLayout& layout_;
  double least_share_;
  std::uint64_t seed_;
  std::size_t tried_ = 0, claims_ = 0;
  double significance_ = 0.0;
  std::vector<double> deviations_;  // of lists of so many motions, see typicalThreshold()
  double typical_, student_;        // thresholds of z_typical and z_mean
  Eigen::VectorXd floor_;           // of the noise, per channel
  Eigen::VectorXd samples_;         // of each motion, per channel
};

}  // namespace raven_correction
