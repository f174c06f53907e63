// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/workspace_coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace raven_correction {
namespace {

constexpr std::size_t kEnough = 10;             // samples of a covered cell
constexpr std::size_t kEnoughTrajectories = 2;  // that they belong to
constexpr std::size_t kAdvice = 5;              // places to record more at, at most

}  // namespace

WorkspaceCoverage workspaceCoverage(const Dataset& dataset, const TrainingConfig& config,
                                    double delay, double cell) {
  const TrainingPairs pairs = makePairs(dataset, config, delay);
  std::vector<Fate> fates(pairs.samples.size(), Fate::kKept);
  if (config.cleaning_enabled && !pairs.samples.empty())
    fates = clean(pairs.samples, config.cleaning).fates;

  WorkspaceCoverage coverage;
  coverage.cell = cell;
  struct Count {
    std::size_t commands = 0, kept = 0;
    std::set<std::size_t> trajectories;
  };
  std::map<std::array<long, 3>, Count> grid;
  std::vector<Eigen::Quaterniond> orientations;
  for (std::size_t i = 0; i < pairs.samples.size(); ++i) {
    const CleaningSample& sample = pairs.samples[i];
    std::array<long, 3> key{};
    for (std::size_t k = 0; k < 3; ++k)
      key[k] = std::lround(std::floor(sample.command.p(static_cast<Eigen::Index>(k)) / cell));
    Count& count = grid[key];
    ++count.commands;
    if (fates[i] != Fate::kKept) {
      coverage.rejected.push_back(sample.command);
      continue;
    }
    ++count.kept;
    count.trajectories.insert(sample.trajectory);
    coverage.kept.push_back(sample.command);
    coverage.speed.push_back(sample.twist.v.norm());
    orientations.push_back(sample.command.q);
  }
  if (!orientations.empty()) {
    const Eigen::Quaterniond middle = meanRotation(orientations);
    for (const Eigen::Quaterniond& q : orientations)
      coverage.angle.push_back(rotationAngle(middle, q));
  }
  for (const auto& [key, count] : grid) {
    const Eigen::Vector3d corner(static_cast<double>(key[0]), static_cast<double>(key[1]),
                                 static_cast<double>(key[2]));
    coverage.cells.push_back({cell * (corner + Eigen::Vector3d::Constant(0.5)), count.commands,
                              count.kept, count.trajectories.size()});
  }
  std::stable_sort(
      coverage.cells.begin(), coverage.cells.end(),
      [](const CoverageCell& a, const CoverageCell& b) { return a.commands > b.commands; });
  for (const CoverageCell& one : coverage.cells) {
    if (one.kept >= kEnough && one.trajectories >= kEnoughTrajectories)
      ++coverage.covered;
    else if (coverage.record_more.size() < kAdvice)
      coverage.record_more.push_back(one);
  }
  return coverage;
}

}  // namespace raven_correction
