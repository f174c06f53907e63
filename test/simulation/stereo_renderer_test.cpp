// SPDX-License-Identifier: BSD-3-Clause
// What the renderer says about a scene against what its images show, and that scenes are what their
// configuration asks for.
#include "raven_correction/simulation/stereo_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

FoamFragment cube(double half) {
  FoamFragment fragment;
  fragment.half_size = Eigen::Vector3d::Constant(half);
  fragment.exponent = 8;
  fragment.finish();
  return fragment;
}

DebridementScene quietScene(const std::vector<FoamFragment>& fragments) {
  DebridementScene scene;
  scene.fragments = fragments;
  scene.sensor.read_noise = 0.0;
  scene.sensor.shot_noise = 0.0;
  return scene;
}

/// Middle of the pixels that are much redder than green.
Eigen::Vector2d middleOfRed(const ColourImage& image, int& count) {
  Eigen::Vector2d sum(0.0, 0.0);
  count = 0;
  for (int v = 0; v < image.height; ++v)
    for (int u = 0; u < image.width; ++u) {
      const std::uint8_t* const pixel = image.bgr.data() + 3 * (v * image.width + u);
      if (pixel[2] < 2 * pixel[1]) continue;
      sum += Eigen::Vector2d(u, v);
      ++count;
    }
  return count > 0 ? Eigen::Vector2d(sum / count) : sum;
}

TEST(FoamFragment, IsMeasuredAsItIsCut) {
  FoamFragment fragment = cube(0.003);
  fragment.half_size.x() = 0.006;
  fragment.finish();
  fragment.X_field_fragment = {{0.01, 0.02, 0.003}, expRotation({0.0, 0.0, 0.7})};
  const FragmentTruth truth = measureFragment(fragment);
  EXPECT_LT((truth.p_field - fragment.X_field_fragment.p).norm(), 1e-6);
  EXPECT_NEAR(truth.yaw, 0.7, 0.035);  // its outline has cells of a twentieth of its size
  // 4 standard deviations of a rectangle are 4 / sqrt(12) of its side; this one has round corners.
  EXPECT_NEAR(truth.length, 0.012 * 4.0 / std::sqrt(12.0), 0.0012);
  EXPECT_NEAR(truth.width, 0.006 * 4.0 / std::sqrt(12.0), 0.0009);
  // A cut takes away one side, and the middle moves to the other.
  fragment.cuts.push_back({Eigen::Vector3d::UnitX(), 0.5});
  fragment.finish();
  EXPECT_NEAR(fragment.p_fragment_centre.x(), -0.25 * 0.006, 1e-4);
}

TEST(FoamFragment, IsHitWhereItsSurfaceIs) {
  const FoamFragment fragment = cube(0.003);
  const auto t = fragment.hit({0.0, 0.0, 0.1}, {0.0, 0.0, -1.0});
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 0.097, 1e-6);
  EXPECT_LT((fragment.normal({0.0, 0.0, 0.003}) - Eigen::Vector3d::UnitZ()).norm(), 1e-6);
  EXPECT_FALSE(fragment.hit({0.0, 0.0, 0.1}, {0.0, 0.0, 1.0}));
  EXPECT_FALSE(fragment.hit({0.0, 0.01, 0.1}, {0.0, 0.0, -1.0}));
}

TEST(StereoRenderer, PutsAFragmentWhereTheCamerasSeeIt) {
  const StereoRig rig = makeStereoRig({});
  FoamFragment fragment = cube(0.002);
  fragment.X_field_fragment.p = {0.021, -0.017, 0.002};
  const StereoPicture picture =
      develop(StereoRenderer(rig.camera).expose(quietScene({fragment}), rig.X_field_camera), 1);
  const Eigen::Vector3d p_camera = rig.X_field_camera.inverse() * fragment.X_field_fragment.p;
  int count = 0;
  EXPECT_LT((middleOfRed(picture.left, count) - rig.camera.leftRawPixel(p_camera)).norm(), 1.0);
  EXPECT_GT(count, 100);
  EXPECT_LT((middleOfRed(picture.right, count) - rig.camera.rightRawPixel(p_camera)).norm(), 1.0);
  ASSERT_EQ(picture.fragments.size(), 1u);
  EXPECT_EQ(picture.fragments[0].visible_left, 1.0);
  EXPECT_EQ(picture.fragments[0].visible_right, 1.0);
}

TEST(StereoRenderer, KnowsHowMuchIsHidden) {
  StereoRigConfig config;
  config.tilt = 0.0;
  const StereoRig rig = makeStereoRig(config);
  FoamFragment lower = cube(0.003);
  lower.X_field_fragment.p = {0.0, 0.0, 0.003};
  FoamFragment upper = cube(0.003);
  upper.X_field_fragment.p = {0.0, 0.003, 0.009};  // over half of it, as seen along y
  const StereoExposure exposure =
      StereoRenderer(rig.camera).expose(quietScene({lower, upper}), rig.X_field_camera);
  EXPECT_EQ(exposure.fragments[1].visible_left, 1.0);
  EXPECT_NEAR(exposure.fragments[0].visible_left, 0.5, 0.12);
  EXPECT_NEAR(exposure.fragments[0].visible_left, exposure.fragments[0].visible_right, 0.05);
}

TEST(StereoRenderer, AnotherFrameDiffersByNoiseAlone) {
  const StereoRig rig = makeStereoRig({});
  const DebridementScene scene = makeDebridementScene({}, 5);
  const StereoExposure exposure = StereoRenderer(rig.camera).expose(scene, rig.X_field_camera);
  const StereoPicture a = develop(exposure, 1);
  EXPECT_EQ(a.left.bgr, develop(exposure, 1).left.bgr);
  const StereoPicture b = develop(exposure, 2);
  double square = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < a.left.bgr.size(); ++i) {
    const double d = static_cast<double>(a.left.bgr[i]) - b.left.bgr[i];
    sum += d;
    square += d * d;
  }
  const auto n = static_cast<double>(a.left.bgr.size());
  EXPECT_GT(square / n, 0.5);
  EXPECT_LT(std::sqrt(square / n), 12.0);
  EXPECT_LT(std::abs(sum / n), 0.05);
}

TEST(DebridementScene, IsWhatItsConfigurationAsksFor) {
  DebridementSceneConfig config;
  int fragments = 0;
  int leaning = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const DebridementScene scene = makeDebridementScene(config, seed);
    EXPECT_LE(scene.fragments.size(), 9u);
    for (const FoamFragment& fragment : scene.fragments) {
      ++fragments;
      const FragmentTruth truth = measureFragment(fragment);
      EXPECT_LT(truth.p_field.head<2>().cwiseAbs().maxCoeff(), 0.04);
      EXPECT_GT(truth.p_field.z(), 0.001);
      leaning += fragment.X_field_fragment.q.vec().head<2>().norm() > 0.02;
    }
  }
  EXPECT_GT(fragments, 60);
  EXPECT_GT(leaning, 5);
  config.fragments_min = config.fragments_max = 0;
  EXPECT_TRUE(makeDebridementScene(config, 1).fragments.empty());
  config.fragments_max = -1;
  EXPECT_THROW(makeDebridementScene(config, 1), InvalidInput);
}

TEST(StereoRig, RefusesWhatCannotStandOverAField) {
  StereoRigConfig config;
  config.baseline = 0.0;
  EXPECT_THROW(makeStereoRig(config), InvalidInput);
  config = {};
  config.tilt = 2.0;
  EXPECT_THROW(makeStereoRig(config), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
