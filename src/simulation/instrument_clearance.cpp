// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/instrument_clearance.h"

#include <algorithm>

namespace raven_correction {

double clearance(const Obstacle& a, const Obstacle& b) noexcept {
  const auto fromPoint = [](const Eigen::Vector3d& p, const Obstacle& piece) {
    const Eigen::Vector3d along = piece.to - piece.from;
    const double length2 = along.squaredNorm();
    const double s =
        length2 > 0.0 ? std::clamp((p - piece.from).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (piece.from + s * along - p).norm();
  };
  // Nearest at an end of one of them, or where the straight lines pass one another.
  double distance = std::min(
      {fromPoint(a.from, b), fromPoint(a.to, b), fromPoint(b.from, a), fromPoint(b.to, a)});
  const Eigen::Vector3d u = a.to - a.from, v = b.to - b.from, w = a.from - b.from;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-12 * uu * vv) {
    const double s = (uv * v.dot(w) - vv * u.dot(w)) / determinant;
    const double t = (uu * v.dot(w) - uv * u.dot(w)) / determinant;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0)
      distance = std::min(distance, (w + s * u - t * v).norm());
  }
  return distance - a.radius - b.radius;
}

}  // namespace raven_correction
