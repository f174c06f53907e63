// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/cleaning/least_median.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "raven_correction/error.h"
#include "raven_correction/geometry/rigid_fit.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

double residual(const Pose& X, const Pose& from, const Pose& to, double rotation_length) {
  const Pose mapped = X * from;
  const double turn = rotation_length * rotationAngle(mapped.q, to.q);
  return std::sqrt((mapped.p - to.p).squaredNorm() + turn * turn);
}

std::vector<double> residuals(const Pose& X, const std::vector<Pose>& from,
                              const std::vector<Pose>& to, double rotation_length) {
  std::vector<double> r(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) r[i] = residual(X, from[i], to[i], rotation_length);
  return r;
}

Pose fitChosen(const LeastMedianProblem& problem, const std::vector<std::size_t>& chosen) {
  RigidFitProblem fit;
  fit.rotation_length = problem.rotation_length;
  for (const std::size_t i : chosen) {
    fit.from.push_back(problem.from[i]);
    fit.to.push_back(problem.to[i]);
  }
  return fitRigid(fit).X_b_a;
}

}  // namespace

LeastMedianResult fitLeastMedian(const LeastMedianProblem& problem) {
  const std::size_t n = problem.from.size();
  if (n != problem.to.size())
    throw InvalidInput(format("least median: %zu poses to map onto %zu; the lists must be pairs", n,
                              problem.to.size()));
  if (!(problem.rotation_length > 0.0) || problem.candidates < 1 || problem.subset < 1)
    throw InvalidInput(
        format("least median: rotation_length = %g m must be > 0, candidates = %d "
               "and subset = %d >= 1",
               problem.rotation_length, problem.candidates, problem.subset));
  LeastMedianResult result;
  result.status = LeastMedianResult::Status::kTooFewPairs;
  if (n < 12 || n < static_cast<std::size_t>(problem.subset)) return result;

  // The pairs that candidates are scored on.
  LeastMedianProblem scored = problem;
  if (n > problem.max_scored) {
    scored.from.clear();
    scored.to.clear();
    const double stride = static_cast<double>(n) / static_cast<double>(problem.max_scored);
    for (std::size_t k = 0; k < problem.max_scored; ++k) {
      const auto i = static_cast<std::size_t>(static_cast<double>(k) * stride);
      scored.from.push_back(problem.from[i]);
      scored.to.push_back(problem.to[i]);
    }
  }
  const auto score = [&](const Pose& X) {
    return median(residuals(X, scored.from, scored.to, problem.rotation_length));
  };

  std::mt19937_64 random(problem.seed);
  std::uniform_int_distribution<std::size_t> any(0, n - 1);
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < problem.candidates; ++k) {
    std::vector<std::size_t> subset(static_cast<std::size_t>(problem.subset));
    for (std::size_t& i : subset) i = any(random);
    const Pose X = fitChosen(problem, subset);
    const double value = score(X);
    if (value < best) {
      best = value;
      result.X_to_from = X;
    }
  }
  for (int step = 0; step < 20; ++step) {
    const std::vector<double> r =
        residuals(result.X_to_from, scored.from, scored.to, problem.rotation_length);
    std::vector<std::size_t> better_half;
    for (std::size_t i = 0; i < r.size(); ++i)
      if (r[i] <= best) better_half.push_back(i);
    const Pose X = fitChosen(scored, better_half);
    const double value = score(X);
    if (!(value < best)) break;
    best = value;
    result.X_to_from = X;
  }
  result.residuals = residuals(result.X_to_from, problem.from, problem.to, problem.rotation_length);
  result.scale = 1.4826 * (1.0 + 5.0 / static_cast<double>(n - 6)) * median(result.residuals);
  result.status = LeastMedianResult::Status::kOk;
  return result;
}

}  // namespace raven_correction
