// SPDX-License-Identifier: BSD-3-Clause
// Where an arm is by the joints of a JointState, whatever the robot's software calls them: what
// dataset/stream_check.h tells the arms apart by. The chain itself is robot/kinematic_chain.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raven_correction/dataset/stream_check.h"
#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction {

/// Joints of the chain among the named ones, by the names of config/robots or by those of the CRTK
/// branch (gold_ins) and of the Berkeley stack (wrist_joint_L); wrist_yaw also from the fingers.
/// @return nothing where one is missing
std::optional<JointVector> jointsOfChain(const KinematicChain& chain,
                                         const std::vector<std::string>& names,
                                         const Eigen::VectorXd& positions);

/// @param robot   file of the chain that the streams are taken for; empty: no arm is checked
/// @param others  files of arms that they might be mixed up with
/// @param base_frame  of the poses; empty: not known
/// @throws InvalidInput  a file cannot be used, or is of a robot in another frame
std::vector<ArmKinematics> loadArms(const std::string& robot,
                                    const std::vector<std::string>& others,
                                    const std::string& base_frame);

}  // namespace raven_correction
