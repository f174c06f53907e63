// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/learnable.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "observed_samples.h"
#include "raven_correction/regression/gaussian_process.h"
#include "raven_correction/regression/gp_predictor.h"

namespace raven_correction {
namespace {

constexpr double kIntervals[] = {0.05, 0.15, 0.4};  // of the past, as a correction has them [s]
constexpr double kClip = 3.0;                       // in robust deviations [-]
constexpr int kHyperPoints = 300;
constexpr int kMostPoints = 1500;
constexpr Eigen::Index kFewest = 30;  // rows to learn from

/// The set-points of the past as they are known at `now`: straight between two of them, the last
/// one held, before the first at rest.
JointVector setpointAt(const std::vector<Recording::Setpoint>& setpoints, double instant,
                       double now) {
  const auto after = std::upper_bound(
      setpoints.begin(), setpoints.end(), instant,
      [](double t, const Recording::Setpoint& setpoint) { return t < setpoint.stamp; });
  if (after == setpoints.begin()) return after->joints;
  const Recording::Setpoint& before = *std::prev(after);
  if (after == setpoints.end() || after->stamp > now) return before.joints;
  const double share = (instant - before.stamp) / (after->stamp - before.stamp);
  return before.joints + share * (after->joints - before.joints);
}

struct Table {
  Eigen::MatrixXd features, targets;             // one row per sample of the channels that count
  std::vector<int> motions;                      // of every row
  std::vector<std::vector<std::size_t>> blocks;  // of every row: those of its components
  std::vector<Eigen::Index> column;              // of every channel: its first target
};

Table tableOf(const Recording& recording, const ResidualLayout& layout,
              const Eigen::VectorXd& residual, const Eigen::MatrixXd& joints,
              const Eigen::VectorXd& scales) {
  Table table;
  Eigen::Index columns = 0;
  for (const Channel& channel : layout.channels) {
    table.column.push_back(columns);
    if (!channel.encoder) columns += channel.size;
  }
  const std::vector<ObservedSample> samples = observedSamples(recording, layout, joints);
  const auto rows = static_cast<Eigen::Index>(samples.size());
  const Eigen::Index n = recording.robot.size();
  const auto intervals = static_cast<Eigen::Index>(std::size(kIntervals));
  table.features.resize(rows, n * (1 + intervals));
  table.targets = Eigen::MatrixXd::Zero(rows, columns);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const ObservedSample& sample = samples[static_cast<std::size_t>(r)];
    const auto& motion = recording.motions[static_cast<std::size_t>(sample.motion)];
    const double stamp = sample.stamp;
    table.motions.push_back(sample.motion);
    table.blocks.push_back(sample.blocks);
    table.features.row(r).head(n) = sample.joints.transpose();
    JointVector later = setpointAt(motion.setpoints, stamp, stamp);
    double end = 0.0;
    for (Eigen::Index k = 0; k < intervals; ++k) {
      const JointVector before = setpointAt(motion.setpoints, stamp - kIntervals[k], stamp);
      table.features.row(r).segment(n * (1 + k), n) =
          ((later - before) / (kIntervals[k] - end)).transpose();
      later = before;
      end = kIntervals[k];
    }
    for (const std::size_t b : sample.blocks) {
      const ResidualBlock& block = layout.blocks[b];
      const auto c = static_cast<std::size_t>(block.channel);
      for (int i = 0; i < layout.channels[c].size; ++i)
        table.targets(r, table.column[c] + i) =
            std::clamp(residual(block.offset + i) / scales(block.channel), -kClip, kClip);
    }
  }
  return table;
}

/// Outputs of one channel share a kernel; speeds of one interval share a length scale, in units of
/// their deviations, and so do all joints.
GpConfig configOf(const ResidualLayout& layout, Eigen::Index joints, std::uint64_t seed) {
  GpConfig config;
  config.criterion = HyperCriterion::kValidation;
  config.backend = GpBackend::kExact;
  config.max_hyper_points = kHyperPoints;
  config.max_exact_points = kMostPoints;
  config.exact_variance_points = 1;  // means only are asked for
  config.seed = seed;
  int output = 0;
  for (const Channel& channel : layout.channels) {
    if (channel.encoder) continue;
    config.groups.emplace_back();
    for (int i = 0; i < channel.size; ++i) config.groups.back().push_back(output++);
  }
  for (int k = 0; k <= static_cast<int>(std::size(kIntervals)); ++k)
    config.feature_blocks.insert(config.feature_blocks.end(), static_cast<std::size_t>(joints), k);
  return config;
}

Eigen::MatrixXd rowsOf(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows) {
  Eigen::MatrixXd chosen(static_cast<Eigen::Index>(rows.size()), matrix.cols());
  for (std::size_t i = 0; i < rows.size(); ++i)
    chosen.row(static_cast<Eigen::Index>(i)) = matrix.row(rows[i]);
  return chosen;
}

}  // namespace

Eigen::VectorXd withoutLearnable(const Recording& recording, const ResidualLayout& layout,
                                 const Eigen::VectorXd& residual, const Eigen::MatrixXd& joints,
                                 int folds, std::uint64_t seed) {
  Eigen::VectorXd left = residual;
  const Eigen::VectorXd scales = channelScales(layout, residual);
  const Table table = tableOf(recording, layout, residual, joints, scales);
  const GpConfig config = configOf(layout, recording.robot.size(), seed);
  for (int fold = 0; fold < folds; ++fold) {
    std::vector<Eigen::Index> learn, test;
    std::vector<int> groups;
    for (std::size_t r = 0; r < table.motions.size(); ++r) {
      const bool tests = table.motions[r] % folds == fold;
      (tests ? test : learn).push_back(static_cast<Eigen::Index>(r));
      if (!tests) groups.push_back(table.motions[r]);
    }
    if (static_cast<Eigen::Index>(learn.size()) < kFewest || test.empty()) continue;
    const GpModel model =
        fitGp(rowsOf(table.features, learn), rowsOf(table.targets, learn), config, groups).model;
    Eigen::MatrixXd predicted;
    GpPredictor(model).predict(rowsOf(table.features, test), predicted, nullptr);
    for (std::size_t i = 0; i < test.size(); ++i) {
      for (const std::size_t b : table.blocks[static_cast<std::size_t>(test[i])]) {
        const ResidualBlock& block = layout.blocks[b];
        const auto c = static_cast<std::size_t>(block.channel);
        for (int k = 0; k < layout.channels[c].size; ++k)
          left(block.offset + k) -=
              scales(block.channel) * predicted(static_cast<Eigen::Index>(i), table.column[c] + k);
      }
    }
  }
  return left;
}

}  // namespace raven_correction
