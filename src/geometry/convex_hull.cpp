// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/convex_hull.h"

#include <libqhullcpp/Qhull.h>
#include <libqhullcpp/QhullError.h>
#include <libqhullcpp/QhullFacetList.h>
#include <libqhullcpp/QhullPoint.h>
#include <libqhullcpp/QhullVertexSet.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kFlat = 1e-9;  // of the extent [-]

bool spansABody(const std::vector<Eigen::Vector3d>& points) {
  if (points.size() < 4) return false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) moments += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d sizes = moments.jacobiSvd().singularValues();  // squares of lengths
  return sizes(2) > kFlat * kFlat * sizes(0);
}

}  // namespace

std::vector<Triangle> convexHull(const std::vector<Eigen::Vector3d>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      throw InvalidInput(format("convex hull: point %zu of %zu is not finite", i, points.size()));
  if (!spansABody(points)) return {};
  std::vector<double> coordinates;
  for (const Eigen::Vector3d& p : points)
    coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
  std::vector<Triangle> triangles;
  try {
    const orgQhull::Qhull hull("", 3, static_cast<int>(points.size()), coordinates.data(), "Qt");
    for (const orgQhull::QhullFacet& facet : hull.facetList()) {
      const orgQhull::QhullVertexSet corners = facet.vertices();
      Triangle triangle{};
      for (int k = 0; k < 3; ++k)
        triangle[static_cast<std::size_t>(k)] = static_cast<std::size_t>(corners[k].point().id());
      const double* const n = facet.hyperplane().coordinates();
      const Eigen::Vector3d a = points[triangle[1]] - points[triangle[0]];
      const Eigen::Vector3d b = points[triangle[2]] - points[triangle[0]];
      if (a.cross(b).dot(Eigen::Vector3d(n[0], n[1], n[2])) < 0.0)
        std::swap(triangle[1], triangle[2]);
      triangles.push_back(triangle);
    }
  } catch (const orgQhull::QhullError&) {  // as flat as its own tolerance
    return {};
  }
  return triangles;
}

}  // namespace raven_correction
