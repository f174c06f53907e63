// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/robot/gravity_load.h"

#include <array>

namespace raven_correction {

JointVector gravityLoad(const KinematicChain& chain, const JointVector& q,
                        double payload) noexcept {
  const int n = chain.size();
  LinkPoses X_base_link;
  chain.linkPoses(q, X_base_link);
  JointVector load(n);
  // From the tip to the base: force and its moment about the base's origin, of all links so far.
  const Pose X_base_tool = X_base_link[static_cast<std::size_t>(n - 1)] * chain.toolTransform();
  Eigen::Vector3d force = payload * chain.gravity();
  Eigen::Vector3d moment = X_base_tool.p.cross(force);
  for (int j = n - 1; j >= 0; --j) {
    const Joint& joint = chain.joints()[static_cast<std::size_t>(j)];
    const Pose& X = X_base_link[static_cast<std::size_t>(j)];
    if (joint.mass > 0.0) {
      const Eigen::Vector3d weight = joint.mass * chain.gravity();
      force += weight;
      moment += (X * joint.centre_of_mass).cross(weight);
    }
    const Eigen::Vector3d axis = joint.sign * (X.q * Eigen::Vector3d::UnitZ());
    load(j) =
        joint.type == JointType::kRevolute ? axis.dot(moment - X.p.cross(force)) : axis.dot(force);
  }
  return load;
}

}  // namespace raven_correction
