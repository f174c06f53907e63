// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/differentiation.h"

#include <algorithm>
#include <cassert>

namespace raven_correction {
namespace {

/// Derivative at t of the Lagrange polynomials of `count` nodes: product rule, term by term.
void lagrangeDerivative(const double* nodes, std::size_t count, double t, double* weights) {
  for (std::size_t k = 0; k < count; ++k) {
    double sum = 0.0;
    for (std::size_t left_out = 0; left_out < count; ++left_out) {
      if (left_out == k) continue;
      double product = 1.0 / (nodes[k] - nodes[left_out]);
      for (std::size_t j = 0; j < count; ++j)
        if (j != k && j != left_out) product *= (t - nodes[j]) / (nodes[k] - nodes[j]);
      sum += product;
    }
    weights[k] = sum;
  }
}

}  // namespace

std::array<double, 5> fivePointWeights(const std::array<double, 5>& stamps, double t) noexcept {
  std::array<double, 5> weights;
  lagrangeDerivative(stamps.data(), stamps.size(), t, weights.data());
  return weights;
}

Twist centralTwist(const PoseStream& stream, std::size_t index) {
  assert(index < stream.size());
  const std::size_t count = std::min<std::size_t>(5, stream.size());
  const std::size_t wanted = index < 2 ? 0 : index - 2;
  const std::size_t first = std::min(wanted, stream.size() - count);
  const StampedPose& centre = stream[index];
  // Times relative to the centre: stamps of Unix time leave 2e-7 s of resolution, no need for less.
  std::array<double, 5> nodes{};
  for (std::size_t k = 0; k < count; ++k) nodes[k] = stream[first + k].stamp - centre.stamp;
  std::array<double, 5> weights{};
  lagrangeDerivative(nodes.data(), count, 0.0, weights.data());
  Twist twist;
  for (std::size_t k = 0; k < count; ++k) {
    const Pose& pose = stream[first + k].pose;
    twist.v += weights[k] * (pose.p - centre.pose.p);
    twist.w += weights[k] * logRotation(pose.q * centre.pose.q.conjugate());
  }
  return twist;
}

Twist causalTwist(const StampedPose* samples, std::size_t count, double window) noexcept {
  assert(count > 0);
  Twist twist;
  if (count < 2) return twist;
  const StampedPose& now = samples[count - 1];
  std::size_t first = count - 2;
  while (first > 0 && now.stamp - samples[first - 1].stamp <= window) --first;
  double mean_time = 0.0;
  for (std::size_t i = first; i < count; ++i) mean_time += samples[i].stamp - now.stamp;
  mean_time /= static_cast<double>(count - first);
  double spread = 0.0;
  for (std::size_t i = first; i < count; ++i) {
    const double t = samples[i].stamp - now.stamp - mean_time;
    spread += t * t;
    twist.v += t * (samples[i].pose.p - now.pose.p);
    twist.w += t * logRotation(samples[i].pose.q * now.pose.q.conjugate());
  }
  twist.v /= spread;
  twist.w /= spread;
  return twist;
}

}  // namespace raven_correction
