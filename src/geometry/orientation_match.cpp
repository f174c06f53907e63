// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/orientation_match.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr std::size_t kReferences = 9;

/// Median angle between each of seen and the matrix times that of told [rad].
double medianAngle(const Eigen::Matrix4d& matrix, const std::vector<Eigen::Quaterniond>& told,
                   const std::vector<Eigen::Quaterniond>& seen) {
  std::vector<double> angles(told.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    const double cosine = std::abs(seen[i].coeffs().dot(matrix * told[i].coeffs()));
    angles[i] = 2.0 * std::acos(std::min(1.0, cosine));
  }
  return median(angles);
}

/// The matrices of determinant 1 and -1 that bring told nearest to seen. q and -q are one
/// orientation: signs say which of the two is meant.
std::pair<Eigen::Matrix4d, Eigen::Matrix4d> nearestOrthogonal(
    const std::vector<Eigen::Quaterniond>& told, const std::vector<Eigen::Quaterniond>& seen,
    const std::vector<double>& signs) {
  Eigen::Matrix4d moments = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < told.size(); ++i)
    moments += signs[i] * seen[i].coeffs() * told[i].coeffs().transpose();
  const Eigen::JacobiSVD<Eigen::Matrix4d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix4d nearest = svd.matrixU() * svd.matrixV().transpose();
  // The smallest singular value costs least to turn over.
  const Eigen::Matrix4d other =
      nearest - 2.0 * svd.matrixU().col(3) * svd.matrixV().col(3).transpose();
  if (nearest.determinant() > 0.0) return {nearest, other};
  return {other, nearest};
}

}  // namespace

OrientationMatch matchOrientations(const std::vector<Eigen::Quaterniond>& told,
                                   const std::vector<Eigen::Quaterniond>& seen) {
  if (told.empty()) return {};
  // One of the references may be an outlier; one of these few is none.
  const std::size_t step = std::max<std::size_t>(1, told.size() / kReferences);
  OrientationMatch best{M_PI, M_PI};
  for (std::size_t reference = 0; reference < told.size(); reference += step) {
    std::vector<double> signs(told.size());
    for (std::size_t i = 0; i < told.size(); ++i)
      signs[i] = std::copysign(1.0, told[i].coeffs().dot(told[reference].coeffs()) *
                                        seen[i].coeffs().dot(seen[reference].coeffs()));
    const auto [turned, mirrored] = nearestOrthogonal(told, seen, signs);
    best.turned = std::min(best.turned, medianAngle(turned, told, seen));
    best.mirrored = std::min(best.mirrored, medianAngle(mirrored, told, seen));
  }
  return best;
}

}  // namespace raven_correction
