// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/robot/inverse_kinematics.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "raven_correction/robot/remote_centre_arm.h"

namespace raven_correction {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kCharacteristicLength = 0.05;  // scales translations against rotations [m]
constexpr double kReproduced = 1e-7;            // largest pose error of a solution [rad; x 0.05 m]
constexpr int kMaxIterations = 60;              // of the Newton solver, per start

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// What is missing from X to X_target, in `base`: translation / 0.05 m, rotation vector.
Vector6 scaledError(const Pose& X_target, const Pose& X) noexcept {
  Vector6 error;
  error.head<3>() = (X_target.p - X.p) / kCharacteristicLength;
  error.tail<3>() = logRotation(X_target.q * X.q.conjugate());
  return error;
}

/// One Newton step for square chains, a damped one otherwise. Returns 1 / |inv(J)|_F, 0 if
/// singular.
double newtonStep(const Jacobian& J_scaled, const Vector6& error, double damping,
                  JointVector& step) noexcept {
  const Eigen::Index n = J_scaled.cols();
  if (n == 6 && damping == 0.0) {
    const Eigen::Matrix<double, 6, 6> J = J_scaled;
    const Eigen::PartialPivLU<Eigen::Matrix<double, 6, 6>> lu(J);
    const Eigen::Matrix<double, 6, 6> inverse = lu.inverse();
    if (!inverse.allFinite()) return 0.0;
    step = inverse * error;
    return 1.0 / inverse.norm();
  }
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints> A =
      J_scaled.transpose() * J_scaled;
  A.diagonal().array() += damping;
  const JointVector right = J_scaled.transpose() * error;
  step = A.partialPivLu().solve(right);
  return 0.0;
}

}  // namespace

const char* toString(IkStatus status) noexcept {
  switch (status) {
    case IkStatus::kOk:
      return "ok";
    case IkStatus::kOutsideLimits:
      return "outside limits";
    case IkStatus::kSingular:
      return "singular";
    case IkStatus::kUnreachable:
      return "unreachable";
    case IkStatus::kInvalidInput:
      break;
  }
  return "invalid input";
}

bool reproducesPose(IkStatus status) noexcept {
  return status == IkStatus::kOk || status == IkStatus::kOutsideLimits ||
         status == IkStatus::kSingular;
}

InverseKinematics::InverseKinematics(const KinematicChain& chain, const IkOptions& options)
    : chain_(chain), options_(options), closed_form_(RemoteCentreArm::make(chain)) {}

void InverseKinematics::nearestTurn(const JointVector& seed, JointVector& q) const noexcept {
  for (int i = 0; i < chain_.size(); ++i) {
    if (chain_.joints()[i].type != JointType::kRevolute) continue;
    q(i) += kTwoPi * std::round((seed(i) - q(i)) / kTwoPi);
    if (!options_.inside_first) continue;
    const double tolerance = options_.limit_tolerance;
    if (q(i) > chain_.upper()(i) + tolerance && q(i) - kTwoPi >= chain_.lower()(i) - tolerance)
      q(i) -= kTwoPi;
    else if (q(i) < chain_.lower()(i) - tolerance && q(i) + kTwoPi <= chain_.upper()(i) + tolerance)
      q(i) += kTwoPi;
  }
}

double InverseKinematics::distance(const JointVector& a, const JointVector& b) const noexcept {
  double sum = 0.0;
  for (int i = 0; i < chain_.size(); ++i) {
    const bool revolute = chain_.joints()[i].type == JointType::kRevolute;
    const double d = (a(i) - b(i)) / (revolute ? 1.0 : options_.metres_per_radian);
    sum += d * d;
  }
  return sum;
}

bool InverseKinematics::nearestCandidate(const Pose& X_base_tool, const JointVector& seed,
                                         JointVector& q) const noexcept {
  RemoteCentreArm::Solutions candidates;
  const int count = closed_form_->solve(X_base_tool, seed, candidates);
  bool best_inside = false;
  double best_distance = std::numeric_limits<double>::infinity();
  for (int c = 0; c < count; ++c) {
    JointVector candidate = candidates[static_cast<std::size_t>(c)];
    nearestTurn(seed, candidate);
    const bool inside =
        !options_.inside_first || chain_.withinLimits(candidate, options_.limit_tolerance);
    const double d = distance(candidate, seed);
    if (inside < best_inside || (inside == best_inside && !(d < best_distance))) continue;
    best_inside = inside;
    best_distance = d;
    q = candidate;
  }
  return count > 0;
}

bool InverseKinematics::iterate(const Pose& X_base_tool, JointVector& q) const noexcept {
  double damping = 1e-4;
  Jacobian J;
  JointVector step;
  Vector6 error = scaledError(X_base_tool, chain_.forward(q, J));
  for (int k = 0; k < kMaxIterations; ++k) {
    if (error.norm() < 1e-3 * kReproduced) return true;
    J.topRows<3>() /= kCharacteristicLength;
    newtonStep(J, error, damping, step);
    if (!step.allFinite()) return false;
    Jacobian J_next;
    const JointVector q_next = q + step;
    const Vector6 next = scaledError(X_base_tool, chain_.forward(q_next, J_next));
    if (next.squaredNorm() < error.squaredNorm()) {
      q = q_next;
      error = next;
      J = J_next;
      damping = std::max(0.1 * damping, 1e-14);
    } else {
      J.topRows<3>() *= kCharacteristicLength;
      damping *= 10.0;
      if (damping > 1e8) break;
    }
  }
  return error.norm() < kReproduced;
}

bool InverseKinematics::search(const Pose& X_base_tool, const JointVector& seed,
                               JointVector& q) const noexcept {
  // From the seed first; then from the corners of the middle half of the limits, which start on
  // every branch of a usual arm. The first solution inside the limits is taken.
  const JointVector middle = 0.5 * (chain_.lower() + chain_.upper());
  const JointVector quarter = 0.25 * (chain_.upper() - chain_.lower());
  bool found = false;
  const int starts = options_.search_elsewhere ? 1 << std::min(chain_.size(), 5) : 0;
  for (int start = -1; start < starts; ++start) {
    JointVector trial = seed;
    if (start >= 0) {
      trial = middle;
      for (int i = 0; i < chain_.size(); ++i)
        trial(i) += ((start >> (i % 5)) & 1 ? 1.0 : -1.0) * quarter(i);
    }
    if (!iterate(X_base_tool, trial)) continue;
    nearestTurn(seed, trial);
    const bool inside = chain_.withinLimits(trial, options_.limit_tolerance);
    if (inside || !found) q = trial;
    found = true;
    if (inside) break;
  }
  return found;
}

IkResult InverseKinematics::solve(const Pose& X_base_tool, const JointVector& seed) const noexcept {
  IkResult result;
  result.joints = seed;
  if (seed.size() != chain_.size() || !seed.allFinite() || !isFinite(X_base_tool) ||
      !hasUnitQuaternion(X_base_tool))
    return result;
  const Pose X_target{X_base_tool.p, X_base_tool.q.normalized()};
  JointVector q = seed;
  const bool found = closed_form_ ? nearestCandidate(X_target, seed, q) : search(X_target, seed, q);
  if (!found) {
    result.status = IkStatus::kUnreachable;
    return result;
  }
  // One Newton step takes out what the closed form rounds, where the pose determines the joints.
  Jacobian J;
  Vector6 error = scaledError(X_target, chain_.forward(q, J));
  J.topRows<3>() /= kCharacteristicLength;
  JointVector step;
  result.conditioning = chain_.size() == 6 ? newtonStep(J, error, 0.0, step) : 1.0;
  if (chain_.size() == 6 && result.conditioning > options_.min_conditioning && step.norm() < 1e-3) {
    q += step;
    error = scaledError(X_target, chain_.forward(q));
  }
  if (!(error.norm() < kReproduced)) {
    result.status = IkStatus::kUnreachable;
    return result;
  }
  result.joints = q;
  if (!chain_.withinLimits(q, options_.limit_tolerance))
    result.status = IkStatus::kOutsideLimits;
  else if (!(result.conditioning > options_.min_conditioning))
    result.status = IkStatus::kSingular;
  else
    result.status = IkStatus::kOk;
  return result;
}

}  // namespace raven_correction
