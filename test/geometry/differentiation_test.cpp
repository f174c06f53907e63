// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/differentiation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random_poses.h"

namespace raven_correction {
namespace {

TEST(FivePointStencil, IsTheTextbookStencilForEvenStamps) {
  const double h = 0.02;
  const auto w = fivePointWeights({-2 * h, -h, 0.0, h, 2 * h}, 0.0);
  const double expected[] = {1.0, -8.0, 0.0, 8.0, -1.0};
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(w[k], expected[k] / (12.0 * h), 1e-11);
}

TEST(FivePointStencil, IsExactOnQuarticsForUnevenStamps) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), step(0.5, 1.5);
  for (int trial = 0; trial < 200; ++trial) {
    std::array<double, 5> stamps;
    double t = -2.0 + uniform(random);
    for (double& stamp : stamps) stamp = t += step(random);
    double c[5];
    for (double& coefficient : c) coefficient = uniform(random);
    const double at = stamps[2];
    const auto w = fivePointWeights(stamps, at);
    double estimate = 0.0;
    for (std::size_t k = 0; k < 5; ++k) {
      const double s = stamps[k];
      estimate += w[k] * (c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4]))));
    }
    const double truth = c[1] + at * (2 * c[2] + at * (3 * c[3] + at * 4 * c[4]));
    EXPECT_NEAR(estimate, truth, 1e-10);
  }
}

PoseStream constantTwist(const Twist& twist, const std::vector<double>& stamps,
                         std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const Pose start = randomPose(random);
  PoseStream stream;
  for (const double t : stamps)
    stream.push_back({t, {start.p + t * twist.v, expRotation(t * twist.w) * start.q}});
  return stream;
}

std::vector<double> unevenStamps(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> step(0.004, 0.03);
  std::vector<double> stamps{0.0};
  while (stamps.size() < count) stamps.push_back(stamps.back() + step(random));
  return stamps;
}

TEST(CentralTwist, IsExactForConstantTwistAlsoAtTheEndsAndInShortMotions) {
  const Twist twist{{0.05, -0.02, 0.1}, {0.4, -1.1, 0.3}};
  for (const std::size_t count : {2, 3, 4, 5, 20}) {
    const PoseStream stream = constantTwist(twist, unevenStamps(count, count), 2);
    for (std::size_t i = 0; i < count; ++i) {
      const Twist estimate = centralTwist(stream, i);
      EXPECT_LT((estimate.v - twist.v).norm(), 1e-11);
      EXPECT_LT((estimate.w - twist.w).norm(), 1e-11);
    }
  }
  EXPECT_EQ(centralTwist(PoseStream(1), 0).v.norm(), 0.0);
}

TEST(CausalTwist, IsExactForConstantTwistFromTheSecondSampleOn) {
  const Twist twist{{0.05, -0.02, 0.1}, {0.4, -1.1, 0.3}};
  const PoseStream stream = constantTwist(twist, unevenStamps(40, 3), 4);
  EXPECT_EQ(causalTwist(stream.data(), 1, 0.1).v.norm(), 0.0);
  for (std::size_t count = 2; count <= stream.size(); ++count) {
    const Twist estimate = causalTwist(stream.data(), count, 0.1);
    EXPECT_LT((estimate.v - twist.v).norm(), 1e-12);
    EXPECT_LT((estimate.w - twist.w).norm(), 1e-12);
  }
}

TEST(CausalTwist, DoesNotSeeWhatIsOlderThanTheWindow) {
  PoseStream stream = constantTwist({{0.1, 0, 0}, {0, 0, 0}}, {0.0, 0.5, 0.52, 0.54, 0.56}, 5);
  stream.front().pose.p.x() += 1.0;
  EXPECT_NEAR(causalTwist(stream.data(), stream.size(), 0.1).v.x(), 0.1, 1e-12);
}

TEST(CausalTwist, NoiseGainIsAsDerived) {
  // n samples spaced by h: sigma sqrt(12 / (n (n^2 - 1))) / h. The sample deviation of 20000 trials
  // is known to 1/sqrt(2 * 20000) = 0.5 %; five of these are 2.5 %.
  const double h = 1.0 / 120.0, sigma = 1e-4;
  const std::size_t n = 13;  // 0.1 s, both ends included
  const double predicted = sigma * std::sqrt(12.0 / (double(n) * (double(n * n) - 1.0))) / h;
  std::mt19937_64 random(6);
  double sum = 0.0;
  const int trials = 20000;
  for (int trial = 0; trial < trials; ++trial) {
    PoseStream stream;
    for (std::size_t i = 0; i < n; ++i)
      stream.push_back({h * static_cast<double>(i), {randomVector(random, sigma), {1, 0, 0, 0}}});
    const double v = causalTwist(stream.data(), n, 0.1 + 1e-9).v.x();
    sum += v * v;
  }
  EXPECT_NEAR(std::sqrt(sum / trials) / predicted, 1.0, 0.025);
}

}  // namespace
}  // namespace raven_correction
