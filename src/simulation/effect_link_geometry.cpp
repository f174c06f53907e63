// SPDX-License-Identifier: BSD-3-Clause
// link_geometry: a link angle or length differs from the nominal table of the robot.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class LinkGeometry final : public Effect {
 public:
  explicit LinkGeometry(const KinematicChain& robot) {
    addJointParameters("alpha", robot, {"rad", 0.5, "rad", 0.5}, Sign::kBoth);
    addJointParameters("a", robot, {"m", 0.05, "m", 0.05}, Sign::kBoth);
    addJointParameters("d", robot, {"m", 0.05, "m", 0.05}, Sign::kBoth);
  }
  const char* name() const noexcept override { return "link_geometry"; }
  EffectStage stage() const noexcept override { return EffectStage::kKinematics; }
  const char* equation() const noexcept override { return "alpha_j + alpha, a_j + a, d_j + d"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<LinkGeometry>(*this); }

  KinematicChain links(const KinematicChain& nominal) const override {
    std::vector<Joint> joints = nominal.joints();
    const int n = nominal.size();
    for (int j = 0; j < n; ++j) {
      Joint& joint = joints[static_cast<std::size_t>(j)];
      joint.alpha += value(j);
      joint.a += value(n + j);
      joint.d_offset += value(2 * n + j);
    }
    KinematicChain real(nominal.name(), nominal.frame(), nominal.baseTransform(), joints,
                        nominal.toolTransform());
    real.setGravity(nominal.gravity());
    return real;
  }
};

}  // namespace

std::unique_ptr<Effect> makeLinkGeometry(const KinematicChain& robot) {
  return std::make_unique<LinkGeometry>(robot);
}

}  // namespace raven_correction
