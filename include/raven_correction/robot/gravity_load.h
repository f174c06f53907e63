// SPDX-License-Identifier: BSD-3-Clause
// What gravity does to every joint of a chain: the link masses of its file, and a payload.
#pragma once

#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction {

/// Generalised force of gravity, with c_i the centre of mass of link i, z_j and o_j the axis of j:
///
///   revolute j:   tau_j = sign_j z_j . sum_{i >= j} (c_i - o_j) x m_i g
///   prismatic j:  f_j   = sign_j z_j . sum_{i >= j} m_i g
///
/// Positive pulls the joint towards +q. The payload hangs at the tool point.
/// @param payload  [kg], >= 0
/// @return one value per joint [Nm or N]
/// Source: virtual work; for the Raven, the gravity compensation of both public stacks.
JointVector gravityLoad(const KinematicChain& chain, const JointVector& q, double payload) noexcept;

}  // namespace raven_correction
