// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/repeatability.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include "raven_correction/error.h"

namespace raven_correction {

std::vector<std::size_t> visitOrder(std::size_t poses, std::size_t rounds, std::uint64_t seed) {
  if (poses == 0 || rounds == 0)
    throw InvalidInput(
        format("%zu poses, %zu visits of each: both must be at least 1", poses, rounds));
  std::mt19937_64 random(seed);
  std::vector<std::size_t> round(poses), order;
  std::iota(round.begin(), round.end(), std::size_t{0});
  for (std::size_t k = 0; k < rounds; ++k) {
    std::shuffle(round.begin(), round.end(), random);
    if (!order.empty() && round.front() == order.back()) std::swap(round.front(), round.back());
    order.insert(order.end(), round.begin(), round.end());
  }
  return order;
}

RepeatabilityResult repeatability(const std::vector<Visit>& visits,
                                  const std::vector<std::size_t>& pose) {
  if (visits.size() != pose.size())
    throw InvalidInput(format("%zu visits, but the pose of %zu", visits.size(), pose.size()));
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  RepeatabilityResult result;
  std::vector<PoseError> errors;
  std::map<std::size_t, std::vector<Vector6>> of_pose;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    if (visits[i].samples == 0) {
      result.unseen.push_back(visits[i].name);
      continue;
    }
    errors.push_back(visits[i].error);
    of_pose[pose[i]].push_back(visits[i].error.components);
  }
  if (errors.empty())
    throw InvalidInput(
        format("none of %zu visits was seen at rest; does motion capture report?", visits.size()));
  result.poses = of_pose.size();
  result.visits = errors.size();
  result.errors = summarise(errors);
  double freedom = 0.0;
  for (const auto& [index, components] : of_pose) {
    const auto n = static_cast<double>(components.size());
    Vector6 mean = Vector6::Zero();
    for (const Vector6& error : components) mean += error / n;
    for (const Vector6& error : components) result.repeatability += (error - mean).cwiseAbs2();
    freedom += n - 1.0;
    result.mean_error += mean.cwiseAbs2() / static_cast<double>(of_pose.size());
  }
  result.repeatability =
      freedom > 0.0 ? (result.repeatability / freedom).cwiseSqrt().eval() : Vector6::Zero().eval();
  result.mean_error = result.mean_error.cwiseSqrt().eval();
  return result;
}

}  // namespace raven_correction
