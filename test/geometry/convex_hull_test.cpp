// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/convex_hull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <set>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

using Points = std::vector<Eigen::Vector3d>;

double volumeOf(const Points& points, const std::vector<Triangle>& triangles) {
  double volume = 0.0;
  for (const Triangle& t : triangles)
    volume += points[t[0]].dot(points[t[1]].cross(points[t[2]])) / 6.0;
  return volume;
}

TEST(ConvexHull, OfABoxIsItsCornersWithOutwardTriangles) {
  Points points;
  for (int corner = 0; corner < 8; ++corner)
    points.emplace_back(corner & 1 ? 0.3 : 0.1, corner & 2 ? 0.5 : 0.2, corner & 4 ? -0.1 : -0.2);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0.01, 0.99);
  for (int i = 0; i < 500; ++i)
    points.emplace_back(0.1 + 0.2 * share(random), 0.2 + 0.3 * share(random),
                        -0.2 + 0.1 * share(random));
  const std::vector<Triangle> triangles = convexHull(points);
  std::set<std::size_t> used;
  for (const Triangle& t : triangles) used.insert(t.begin(), t.end());
  EXPECT_EQ(used, (std::set<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_NEAR(volumeOf(points, triangles), 0.2 * 0.3 * 0.1, 1e-12);  // negative if inside out
}

TEST(ConvexHull, OfRandomPointsHasThemAllInside) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  Points points;
  for (int i = 0; i < 2000; ++i)
    points.emplace_back(normal(random), normal(random), normal(random));
  const std::vector<Triangle> triangles = convexHull(points);
  ASSERT_GE(triangles.size(), 20u);
  for (const Triangle& t : triangles) {
    const Eigen::Vector3d n =
        (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).normalized();
    for (const Eigen::Vector3d& p : points) EXPECT_LT(n.dot(p - points[t[0]]), 1e-9);
  }
}

TEST(ConvexHull, OfWhatSpansNoBodyIsEmpty) {
  EXPECT_TRUE(convexHull({}).empty());
  EXPECT_TRUE(convexHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).empty());
  EXPECT_TRUE(convexHull(Points(100, Eigen::Vector3d(0.1, 0.2, 0.3))).empty());
  Points flat, line;
  for (int i = 0; i < 50; ++i) {
    flat.emplace_back(i % 7, i % 11, 0.25);
    line.emplace_back(i, 2.0 * i, -i);
  }
  EXPECT_TRUE(convexHull(flat).empty());
  EXPECT_TRUE(convexHull(line).empty());
}

TEST(ConvexHull, RefusesWhatIsNotFinite) {
  Points points(5, Eigen::Vector3d::Zero());
  points[3].y() = std::numeric_limits<double>::quiet_NaN();
  try {
    convexHull(points);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("point 3 of 5"), std::string::npos);
  }
}

}  // namespace
}  // namespace raven_correction
