// SPDX-License-Identifier: BSD-3-Clause
// Are two sequences of orientations one motion, seen from two frames and on two parts of a body?
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace raven_correction {

/// Median angles that are left between two sequences [rad].
struct OrientationMatch {
  /// After the best constant rotations A and B of seen = A * told * B: another base frame and
  /// another frame on the body are always of this kind.
  double turned = 0.0;
  /// After the best of seen = A * inverse(told) * B. Quaternions that were written with w first and
  /// are read with w last are of this kind, and so are inverse poses. Where both are as small, the
  /// orientations differ too little, or about too few axes, to tell.
  double mirrored = 0.0;
};

/// As vectors of four numbers unit quaternions that belong together are told apart by an orthogonal
/// matrix: with determinant 1 it is a pair of rotations, with -1 (a cyclic permutation of the
/// four) there is an inverse in between. Both are fitted by least squares (Kabsch in four
/// dimensions, DOI 10.1107/S0567739476001873).
/// @param told, seen  orientations at the same times, of equal number, none of them turned by much
///        more than half a turn against the others; outliers among them do not decide
OrientationMatch matchOrientations(const std::vector<Eigen::Quaterniond>& told,
                                   const std::vector<Eigen::Quaterniond>& seen);

}  // namespace raven_correction
