// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/debridement_field.h"

#include <cmath>
#include <limits>

#include "raven_correction/error.h"

namespace raven_correction {

const char* toString(JawOutcome::Kind kind) noexcept {
  switch (kind) {
    case JawOutcome::Kind::kHeld:
      return "held";
    case JawOutcome::Kind::kMissed:
      return "missed";
    case JawOutcome::Kind::kDelivered:
      return "delivered";
    case JawOutcome::Kind::kDropped:
      return "dropped";
    case JawOutcome::Kind::kLost:
      return "lost";
    case JawOutcome::Kind::kEmpty:
      break;
  }
  return "empty";
}

DebridementField::DebridementField(const DebridementFieldConfig& config) : config_(config) {
  checkGrasp(config.grasp);
  if (!(config.receptacle_radius > 0.0 && config.field_size > 0.0))
    throw InvalidInput(
        format("debridement field: receptacle_radius = %g m, field_size = %g m, must be > 0",
               config.receptacle_radius, config.field_size));
}

void DebridementField::set(const DebridementScene& scene) {
  scene_ = scene;
  numbers_.clear();
  truths_.clear();
  held_.clear();
  delivered_ = lost_ = 0;
  for (const FoamFragment& fragment : scene_.fragments) {
    numbers_.push_back(static_cast<int>(numbers_.size()));
    truths_.push_back(measureFragment(fragment));
  }
}

JawOutcome DebridementField::close(const std::string& gripper, const Pose& X_field_tool,
                                   double opening) {
  JawOutcome outcome;
  outcome.kind = JawOutcome::Kind::kMissed;
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t best = truths_.size();
  for (std::size_t i = 0; i < truths_.size(); ++i) {
    const GraspFit fit = fitGrasp(config_.grasp, truths_[i], X_field_tool, opening);
    const double distance = fit.p_tool_fragment.norm();
    // One that it holds comes before a nearer one that it does not.
    if (fit.holds == outcome.fit.holds ? distance >= nearest : outcome.fit.holds) continue;
    nearest = distance;
    best = i;
    outcome.fit = fit;
  }
  if (!outcome.fit.holds || held_.count(gripper) > 0) return outcome;
  outcome.kind = JawOutcome::Kind::kHeld;
  outcome.fragment = numbers_[best];
  held_[gripper] = {scene_.fragments[best], numbers_[best]};
  const auto at = static_cast<std::ptrdiff_t>(best);
  scene_.fragments.erase(scene_.fragments.begin() + at);
  numbers_.erase(numbers_.begin() + at);
  truths_.erase(truths_.begin() + at);
  return outcome;
}

/// It lies as it lay, at another place of the platform.
void DebridementField::putDown(const Held& held, const Eigen::Vector2d& p_field) {
  FoamFragment fragment = held.fragment;
  const Eigen::Vector3d centre = fragment.X_field_fragment * fragment.p_fragment_centre;
  fragment.X_field_fragment.p.head<2>() += p_field - centre.head<2>();
  fragment.X_field_fragment.p.z() = fragment.half_size.z();
  scene_.fragments.push_back(fragment);
  numbers_.push_back(held.number);
  truths_.push_back(measureFragment(fragment));
}

JawOutcome DebridementField::open(const std::string& gripper, const Pose& X_field_tool) {
  JawOutcome outcome;
  const auto found = held_.find(gripper);
  if (found == held_.end()) return outcome;
  const Held held = found->second;
  held_.erase(found);
  outcome.fragment = held.number;
  const Eigen::Vector2d p = X_field_tool.p.head<2>();
  for (const Eigen::Vector3d& receptacle : config_.p_field_receptacle) {
    // The receptacle stands higher than the field: whoever lets go below its rim is beside it.
    if ((p - receptacle.head<2>()).norm() > config_.receptacle_radius ||
        X_field_tool.p.z() < receptacle.z() - config_.receptacle_radius)
      continue;
    outcome.kind = JawOutcome::Kind::kDelivered;
    ++delivered_;
    return outcome;
  }
  if (p.cwiseAbs().maxCoeff() <= 0.5 * config_.field_size) {
    outcome.kind = JawOutcome::Kind::kDropped;
    putDown(held, p);
  } else {
    outcome.kind = JawOutcome::Kind::kLost;
    ++lost_;
  }
  return outcome;
}

}  // namespace raven_correction
