// SPDX-License-Identifier: BSD-3-Clause
// Velocities from time-stamped poses: the paper's central five-point stencil, which looks ahead,
// and a causal least-squares slope, which does not and is what is deployed live.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "raven_correction/geometry/stream.h"

namespace raven_correction {

/// Weights w of the derivative at t of the polynomial through five values:
///
///   f'(t) ~ sum_k w_k f(t_k),   w_k = L_k'(t),  L_k the Lagrange polynomial of node k
///
/// Exact for polynomials up to the fourth degree and any five different stamps; for even spacing h
/// and t in the middle it is the (1, -8, 0, 8, -1) / (12 h) of the textbooks.
/// @param stamps  five different instants, in any order [s]
/// @param t       where the derivative is wanted [s]
/// @return weights [1/s]
/// Source: Fornberg 1988, doi:10.1090/S0025-5718-1988-0935077-0; Mahler et al. 2014, section IV-B
std::array<double, 5> fivePointWeights(const std::array<double, 5>& stamps, double t) noexcept;

/// Twist of sample `index` by the five-point stencil over its two neighbours on each side; at the
/// ends over the nearest five samples, with fewer than five over as many as there are, and zero
/// for one. The rotational part differentiates rotation vectors relative to sample `index`.
/// Not causal.
/// @param stream  at least one sample, stamps strictly increasing
/// @return twist in the frame of the stream's poses [m/s, rad/s]
Twist centralTwist(const PoseStream& stream, std::size_t index);

/// Twist of a sample from its past: the least-squares slope of position and of the rotation vector
/// relative to that sample, over the samples in [t - window, t]:
///
///   v = sum_i (t_i - m) p_i / S,   S = sum_i (t_i - m)^2,   m = mean of t_i
///
/// Exact for motion with constant velocity and constant angular velocity. White noise of deviation
/// sigma per axis becomes sigma / sqrt(S) in v; for n samples evenly spaced by h that is
/// sigma sqrt(12 / (n (n^2 - 1))) / h. A window that holds one sample only takes the one before it,
/// too; the first sample of a motion has zero twist.
/// @param samples  the motion up to and including the sample, oldest first, stamps strictly
///                 increasing; only the end of it is looked at
/// @param count    of samples, > 0
/// @param window   duration, > 0 [s]
/// @return twist in the frame of the poses [m/s, rad/s]
Twist causalTwist(const StampedPose* samples, std::size_t count, double window) noexcept;

}  // namespace raven_correction
