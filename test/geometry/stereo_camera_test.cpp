// SPDX-License-Identifier: BSD-3-Clause
// Cameras and lenses: there and back, against the formula of the lens written out again, and what a
// wrong calibration is told.
#include "raven_correction/geometry/stereo_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "raven_correction/error.h"
#include "raven_correction/geometry/rotation.h"
#include "raven_correction/simulation/stereo_rig.h"

namespace raven_correction {
namespace {

StereoCamera rig() { return makeStereoRig({}).camera; }

TEST(PinholeCamera, LooksBackAlongTheRayOfItsPixel) {
  const StereoCamera stereo = rig();
  for (const PinholeCamera* camera : {&stereo.left, &stereo.right})
    for (double u = 0.0; u < 640.0; u += 71.0)
      for (double v = 0.0; v < 480.0; v += 53.0) {
        const Eigen::Vector3d ray = camera->rayOf({u, v});
        EXPECT_NEAR(ray.norm(), 1.0, 1e-12);
        EXPECT_LT((camera->rawPixel(0.37 * ray) - Eigen::Vector2d(u, v)).norm(), 1e-8);
      }
}

TEST(PinholeCamera, HasTheLensOfPlumbBob) {
  PinholeCamera camera;
  camera.D << -0.3, 0.1, 0.002, -0.003, 0.05;
  const double x = 0.21;
  const double y = -0.13;
  const double r2 = x * x + y * y;
  const double radial = 1.0 - 0.3 * r2 + 0.1 * r2 * r2 + 0.05 * r2 * r2 * r2;
  const Eigen::Vector2d expected(x * radial + 2 * 0.002 * x * y - 0.003 * (r2 + 2 * x * x),
                                 y * radial + 0.002 * (r2 + 2 * y * y) - 2 * 0.003 * x * y);
  EXPECT_LT((camera.distort({x, y}) - expected).norm(), 1e-15);
  EXPECT_LT((camera.undistort(expected) - Eigen::Vector2d(x, y)).norm(), 1e-13);
}

TEST(StereoCamera, TriangulatesWhatItProjects) {
  const StereoCamera camera = rig();
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0.03, 0.0, 0.3), Eigen::Vector3d(-0.02, 0.05, 0.25),
        Eigen::Vector3d(0.07, -0.04, 0.4)}) {
    const StereoPixel pixel = camera.project(p);
    EXPECT_LT((camera.triangulate(pixel) - p).norm(), 1e-12);
    // The Jacobian against differences.
    const Eigen::Matrix3d J = camera.triangulationJacobian(pixel);
    const double step = 1e-4;
    const Eigen::Vector3d q = camera.triangulate(pixel);
    const StereoPixel moved[] = {{pixel.u_left + step, pixel.u_right, pixel.v},
                                 {pixel.u_left, pixel.u_right + step, pixel.v},
                                 {pixel.u_left, pixel.u_right, pixel.v + step}};
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d slope = (camera.triangulate(moved[i]) - q) / step;
      EXPECT_LT((slope - J.col(i)).norm(), 1e-6 * J.col(i).norm() + 1e-9) << i;
    }
  }
}

TEST(StereoCamera, SeesOnePointOnOneRowAndThroughItsLensesWhereTheyPutIt) {
  const StereoCamera camera = rig();
  const Eigen::Vector3d p(0.05, 0.02, 0.31);
  const Eigen::Vector3d left = camera.left.rayOf(camera.leftRawPixel(p));
  const Eigen::Vector3d right = camera.right.rayOf(camera.rightRawPixel(p));
  EXPECT_LT(left.cross(p.normalized()).norm(), 1e-10);
  const Eigen::Vector3d from_right = p - Eigen::Vector3d(camera.baseline(), 0.0, 0.0);
  EXPECT_LT(right.cross(from_right.normalized()).norm(), 1e-10);
  EXPECT_NEAR(camera.baseline(), 0.06, 1e-12);
}

/// What checkStereoCamera() says about it; empty if nothing.
std::string complaint(const StereoCamera& camera) {
  try {
    checkStereoCamera(camera);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(StereoCamera, SaysWhatIsWrongWithACalibration) {
  EXPECT_EQ(complaint(rig()), "");
  StereoCamera camera = rig();
  camera.left.width = 0;
  EXPECT_NE(complaint(camera).find("left camera: image size 0 x 480"), std::string::npos);
  camera = rig();
  camera.right.K.setZero();
  EXPECT_NE(complaint(camera).find("not calibrated"), std::string::npos);
  camera = rig();
  camera.right.D(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint(camera).find("right camera: K, D, R or P"), std::string::npos);
  camera = rig();
  camera.left.R(0, 0) += 0.1;
  EXPECT_NE(complaint(camera).find("R is no rotation"), std::string::npos);
  camera = rig();
  camera.left.D << -4.0, 0.0, 0.0, 0.0, 0.0;
  EXPECT_NE(complaint(camera).find("cannot be undone"), std::string::npos);
  camera = rig();
  std::swap(camera.left, camera.right);
  EXPECT_NE(complaint(camera).find("swapped"), std::string::npos);
  camera = rig();
  camera.right.P(0, 3) = 0.0;
  EXPECT_NE(complaint(camera).find("baseline"), std::string::npos);
  camera = rig();
  camera.right.P(1, 2) += 3.0;
  EXPECT_NE(complaint(camera).find("do not belong together"), std::string::npos);
}

}  // namespace
}  // namespace raven_correction
