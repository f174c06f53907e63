// SPDX-License-Identifier: BSD-3-Clause
// Joints for a pose: of all solutions the one nearest to a seed, with a status and never a NaN.
// Closed form for arms that pivot about a remote centre (Raven, da Vinci PSM), damped Newton steps
// for any other chain.
#pragma once

#include <memory>

#include "raven_correction/robot/kinematic_chain.h"
#include "raven_correction/robot/remote_centre_arm.h"

namespace raven_correction {

enum class IkStatus {
  kOk,             ///< joints reproduce the pose, inside the limits
  kOutsideLimits,  ///< joints reproduce the pose, but at least one is outside its limits
  kSingular,      ///< joints reproduce the pose, but a small motion of it needs a large one of them
  kUnreachable,   ///< no joints reproduce the pose; joints are the seed
  kInvalidInput,  ///< pose or seed not finite, quaternion not unit, or seed of a wrong size
};
/// "ok", "outside limits", ...
const char* toString(IkStatus status) noexcept;
/// The joints reproduce the pose: kOk, kOutsideLimits or kSingular.
bool reproducesPose(IkStatus status) noexcept;

struct IkOptions {
  double metres_per_radian = 0.1;  ///< "nearest" weighs a prismatic joint by its reciprocal [m/rad]
  double limit_tolerance = 1e-9;   ///< a joint may exceed its limit by this much [rad or m]
  /// kSingular below this value of 1 / |inv(J)|_F, the translation of J divided by 0.05 m. It lies
  /// between the smallest singular value / sqrt(n) and that value; 0.3 in the middle of a Raven's
  /// workspace, 0 at a singularity.
  double min_conditioning = 0.02;
  /// Chains without a closed form: where no solution is found from the seed, look from elsewhere,
  /// too. It takes up to 32 times as long.
  bool search_elsewhere = true;
  /// A solution inside the limits is taken before a nearer one outside. False: the nearest of all.
  bool inside_first = true;
};

struct IkResult {
  IkStatus status = IkStatus::kInvalidInput;
  JointVector joints;  ///< always finite when the seed was, even where the status is an error
  double conditioning = 0.0;  ///< see IkOptions::min_conditioning; 0 if not computed
};

/// Solver for one chain. Immutable, safe to share between threads; solve() does not allocate.
class InverseKinematics {
 public:
  explicit InverseKinematics(const KinematicChain& chain, const IkOptions& options = {});

  /// The solution nearest to `seed`: inside the limits if there is one, else outside
  /// (IkOptions::inside_first). Revolute joints are taken modulo 2 pi at the turn nearest to the
  /// seed, with inside_first as far as the limits allow. About 2 us in closed form.
  /// @param X_base_tool  where the tool shall be, in the chain's frame
  /// @param seed         joints now; one per row of the chain
  IkResult solve(const Pose& X_base_tool, const JointVector& seed) const noexcept;
  bool isClosedForm() const noexcept { return closed_form_ != nullptr; }

 private:
  void nearestTurn(const JointVector& seed, JointVector& q) const noexcept;
  double distance(const JointVector& a, const JointVector& b) const noexcept;
  bool nearestCandidate(const Pose& X_base_tool, const JointVector& seed,
                        JointVector& q) const noexcept;
  bool iterate(const Pose& X_base_tool, JointVector& q) const noexcept;
  bool search(const Pose& X_base_tool, const JointVector& seed, JointVector& q) const noexcept;

  KinematicChain chain_;
  IkOptions options_;
  std::shared_ptr<const RemoteCentreArm> closed_form_;  // null: the chain does not have that form
};

}  // namespace raven_correction
