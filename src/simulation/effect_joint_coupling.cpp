// SPDX-License-Identifier: BSD-3-Clause
// joint_coupling: cables of one joint run over the pulleys of another, so motion of joint j away
// from its homing position moves joint i. All u are taken before any of them is changed.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class JointCoupling final : public Effect {
 public:
  explicit JointCoupling(const KinematicChain& robot) {
    size_ = robot.size();
    for (int i = 0; i < size_; ++i) {
      for (int j = 0; j < size_; ++j) {
        if (i == j) continue;
        const bool moved_revolute = isRevolute(robot, i);
        const bool source_revolute = isRevolute(robot, j);
        EffectParameter parameter;
        parameter.symbol = "c";
        parameter.joint = i;
        parameter.source = j;
        parameter.unit =
            moved_revolute ? (source_revolute ? "-" : "rad/m") : (source_revolute ? "m/rad" : "-");
        parameter.upper = moved_revolute == source_revolute ? 2.0 : (moved_revolute ? 200.0 : 0.2);
        parameter.lower = -parameter.upper;
        addParameter(parameter);
      }
    }
  }
  const char* name() const noexcept override { return "joint_coupling"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  const char* equation() const noexcept override { return "q_i = u_i + sum_j c_ij (u_j - home_j)"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<JointCoupling>(*this); }

  void apply(const StepContext& context, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    const JointVector away = q - context.home;
    int index = 0;
    for (int i = 0; i < size_; ++i) {  // no branch: a diagnosis spends much of its time here
      double moved = 0.0;
      for (int j = 0; j < i; ++j) moved += value(index++) * away(j);
      for (int j = i + 1; j < size_; ++j) moved += value(index++) * away(j);
      q(i) += moved;
    }
  }

 private:
  static bool isRevolute(const KinematicChain& robot, int joint) {
    return robot.joints()[static_cast<std::size_t>(joint)].type == JointType::kRevolute;
  }
  int size_ = 0;
};

}  // namespace

std::unique_ptr<Effect> makeJointCoupling(const KinematicChain& robot) {
  return std::make_unique<JointCoupling>(robot);
}

}  // namespace raven_correction
