// SPDX-License-Identifier: BSD-3-Clause
// The smallest convex body around points in space, by Qhull. A box around them is cheaper and says
// less.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace raven_correction {

/// Indices of three points, counter-clockwise seen from outside.
using Triangle = std::array<std::size_t, 3>;

/// Triangles of the convex hull of points; no triangle where they do not span a body: fewer than
/// four, or all within 1e-9 of their extent of one plane.
/// @param points  finite [any one unit]
/// @throws InvalidInput  a coordinate is not finite
/// Source: Barber, Dobkin, Huhdanpaa 1996, doi:10.1145/235815.235821
std::vector<Triangle> convexHull(const std::vector<Eigen::Vector3d>& points);

}  // namespace raven_correction
