// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/residual_starts.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace raven_correction {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMostPeriods[] = {200.0, 3000.0};  // per radian, per metre: ends of the search
constexpr double kPhaseStep = 0.5 * kPi;   // over the range of the joint, between two periods tried
constexpr std::size_t kMostBlocks = 4000;  // of the search for a period
constexpr double kRidge = 1e-9;
constexpr double kSmallestSide = 0.02;  // share of the observations on either side of a shift [-]

/// What b' A^-1 b explains of the weighted squares.
double explained(Eigen::MatrixXd A, const Eigen::VectorXd& b, Eigen::VectorXd* solution) {
  A.diagonal().array() += kRidge * (A.trace() + 1e-300);
  const Eigen::VectorXd x = A.ldlt().solve(b);
  if (solution) *solution = x;
  return b.dot(x);
}

struct Period {
  double N = 0.0, gain = 0.0;
  Eigen::VectorXd sine_cosine;
};

}  // namespace

std::vector<Eigen::VectorXd> periodicStarts(const ResidualView& view, int joint,
                                            const Eigen::VectorXd& sensitivity, std::size_t most) {
  const ResidualLayout& layout = *view.layout;
  const double range = view.summary->range(joint);
  if (!(range > 0.0)) return {};
  const Eigen::VectorXd weights = rowWeights(layout, *view.residual, view.scales);
  // Of every block: its joint, and what one unit of joint error explains there.
  std::vector<double> q, bb, ab;
  const std::size_t stride = std::max<std::size_t>(1, layout.blocks.size() / kMostBlocks);
  std::size_t samples = 0;
  for (std::size_t i = 0; i < layout.blocks.size(); ++i) {
    const ResidualBlock& block = layout.blocks[i];
    // Whole samples are passed over, so that every channel is seen.
    if (i > 0 && (layout.blocks[i - 1].sample != block.sample ||
                  layout.blocks[i - 1].motion != block.motion))
      ++samples;
    if (samples % stride != 0) continue;
    double squares = 0.0, product = 0.0;
    for (int c = 0; c < layout.sizeOf(block); ++c) {
      const Eigen::Index row = block.offset + c;
      squares += weights(row) * sensitivity(row) * sensitivity(row);
      product -= weights(row) * sensitivity(row) * (*view.residual)(row);
    }
    q.push_back((*view.joints)(joint, static_cast<Eigen::Index>(i)));
    bb.push_back(squares);
    ab.push_back(product);
  }
  const bool revolute =
      view.recording->robot.joints()[static_cast<std::size_t>(joint)].type == JointType::kRevolute;
  const double last = kMostPeriods[revolute ? 0 : 1];
  const double step = kPhaseStep / range;
  std::vector<Period> periods;
  for (double N = 4.0 * step; N < last; N += step) {  // from one wave over the range
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    Eigen::Vector2d wave = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (i == 0 || q[i] != q[i - 1])  // position and orientation share their joints
        wave << std::sin(N * q[i]), std::cos(N * q[i]);
      A += bb[i] * wave * wave.transpose();
      b += ab[i] * wave;
    }
    Period period;
    period.N = N;
    period.gain = explained(A, b, &period.sine_cosine);
    periods.push_back(std::move(period));
  }
  std::sort(periods.begin(), periods.end(),
            [](const Period& a, const Period& b) { return a.gain > b.gain; });
  std::vector<Eigen::VectorXd> starts;
  std::vector<double> taken;
  for (const Period& period : periods) {
    if (starts.size() >= most) break;
    if (std::any_of(taken.begin(), taken.end(),
                    [&](double N) { return std::abs(N - period.N) < 2.5 * step; }))
      continue;
    taken.push_back(period.N);
    const double A = std::clamp(period.sine_cosine.norm(), 1e-6, revolute ? 0.19 : 0.019);
    starts.push_back(
        Eigen::Vector3d(A, period.N, std::atan2(period.sine_cosine(1), period.sine_cosine(0))));
  }
  return starts;
}

std::vector<Eigen::VectorXd> shiftStarts(const ResidualView& view,
                                         const Eigen::MatrixXd& sensitivity) {
  const ResidualLayout& layout = *view.layout;
  const Eigen::VectorXd weights = rowWeights(layout, *view.residual, view.scales);
  // From the last block to the first: everything after an instant, in sums.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(6);
  double best = 0.0, instant = 0.0;
  Eigen::VectorXd pose;
  const std::size_t least =
      static_cast<std::size_t>(kSmallestSide * static_cast<double>(layout.blocks.size())) + 1;
  for (std::size_t back = 0; back < layout.blocks.size(); ++back) {
    const std::size_t i = layout.blocks.size() - 1 - back;
    const ResidualBlock& block = layout.blocks[i];
    for (int c = 0; c < layout.sizeOf(block); ++c) {
      const Eigen::Index row = block.offset + c;
      A += weights(row) * sensitivity.row(row).transpose() * sensitivity.row(row);
      b -= weights(row) * sensitivity.row(row).transpose() * (*view.residual)(row);
    }
    const bool first_of_sample = i == 0 || layout.blocks[i - 1].sample != block.sample ||
                                 layout.blocks[i - 1].motion != block.motion;
    if (!first_of_sample || back < least || i < least) continue;
    Eigen::VectorXd solution;
    const double gain = explained(A, b, &solution);
    if (gain <= best) continue;
    best = gain;
    pose = solution;
    const auto& motion = view.recording->motions[static_cast<std::size_t>(block.motion)];
    double stamp = motion.observations[static_cast<std::size_t>(block.sample)].stamp;
    if (block.sample > 0) {  // between this sample and the one before
      stamp = 0.5 * (stamp + motion.observations[static_cast<std::size_t>(block.sample - 1)].stamp);
    }
    instant = stamp - view.summary->start;
  }
  if (best <= 0.0) return {};
  Eigen::VectorXd start(7);
  start.head<3>() = pose.head<3>().cwiseMax(-0.19).cwiseMin(0.19);
  start.segment<3>(3) = pose.tail<3>().cwiseMax(-1.4).cwiseMin(1.4);
  start(6) = std::max(0.0, instant);
  return {start};
}

}  // namespace raven_correction
