// SPDX-License-Identifier: BSD-3-Clause
// Fragments in rendered scenes: how many are found and how well, whether the covariance tells the
// truth, and what bad input is told. The renderer shares only the camera's geometry with the
// detector.
#include "raven_correction/perception/fragment_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "raven_correction/error.h"
#include "raven_correction/evaluation/fragment_trial.h"
#include "raven_correction/report/fragment_report.h"
#include "support/complaint.h"

namespace raven_correction {
namespace {

constexpr double kMillimetre = 1e-3;

/// One run for all tests that look at its result.
const FragmentScore& score() {
  static const FragmentScore result = [] {
    const FragmentScore s = runFragmentTrial({});
    std::fputs(fragmentText(s).c_str(), stdout);
    return s;
  }();
  return result;
}

TEST(FragmentTrial, HasScenesWorthTrying) {
  EXPECT_EQ(score().scenes, 200);
  EXPECT_GT(score().half_visible, 800);
  EXPECT_GT(score().overlapped, 80);  // at least half visible, but not quite visible
  EXPECT_GT(score().fragments, score().half_visible);
}

// The aim. Measured on these scenes: 99.0 %, 97.6 %, none of 1087 (doc/perception.md).
constexpr double kFoundFloor = 0.98;
constexpr double kWithinFloor = 0.95;

TEST(FragmentTrial, FindsMostOfWhatIsHalfVisible) {
  EXPECT_GE(score().foundShare(), kFoundFloor);
  EXPECT_GE(score().withinShare(kMillimetre), kWithinFloor);
  EXPECT_EQ(score().false_detections, 0);
  EXPECT_LE(score().displaced, 3);
}

// Scenes of which each had one: blood stains that seem to have a height (20065, 20399, 40058), and
// slivers of fragments (the others). As ./run sanitize builds it, rounding brings that of 20399
// back.
TEST(FragmentTrial, SeesNoFragmentInMarksAndSlivers) {
  FragmentTrial trial;
  trial.scenes = 1;
  trial.empty_every = 0;
  int false_detections = 0;
  for (const std::uint64_t seed : {20065, 20399, 40058, 40161, 40230, 40310}) {
    trial.seed = seed;
    const FragmentScore found = runFragmentTrial(trial);
    false_detections += found.false_detections;
    EXPECT_EQ(found.displaced, 0) << seed;
    EXPECT_GT(found.half_visible_found, 0) << seed;
  }
  EXPECT_LE(false_detections, 1) << "of six";
}

TEST(FragmentTrial, TheCovarianceTellsTheTruth) {
  // The squared error by the covariance is 3 on average, and 95 % of them are below 7.81. Shapes
  // are not normally distributed, so roughly.
  double sum = 0.0;
  double inside = 0.0;
  for (const FragmentMatch& match : score().matches) {
    sum += match.mahalanobis2;
    inside += match.mahalanobis2 < 7.815;
  }
  const auto n = static_cast<double>(score().matches.size());
  EXPECT_GT(sum / n, 3.0 / 3.0);
  EXPECT_LT(sum / n, 3.0 * 2.0);
  EXPECT_GT(inside / n, 0.85);
}

TEST(FragmentTrial, TurnsTheGripperAcrossTheLongAxis) {
  int elongated = 0;
  int right = 0;
  double square = 0.0;
  for (const FragmentMatch& match : score().matches) {
    if (match.slenderness < 1.3) continue;
    ++elongated;
    right += std::abs(match.yaw_error) < 15.0 * M_PI / 180.0;
    square += std::pow(match.yaw_error / match.yaw_deviation, 2.0);
  }
  ASSERT_GT(elongated, 200);
  EXPECT_GT(right, 0.80 * elongated);
  EXPECT_LT(square / elongated, 25.0);
}

/// A scene, its rig and its images for OpenCV.
struct Example {
  explicit Example(int index = 0) : scene(renderTrialScene({}, index)) {
    left = cv::Mat(480, 640, CV_8UC3, scene.picture.left.bgr.data());
    right = cv::Mat(480, 640, CV_8UC3, scene.picture.right.bgr.data());
  }
  FragmentDetector detector(const FragmentDetectorConfig& config = {}) const {
    return FragmentDetector(scene.rig.camera, scene.rig.X_field_camera, config);
  }
  FragmentTrialScene scene;
  cv::Mat left, right;
};

TEST(FragmentDetector, KeepsNothingFromOnePairToTheNext) {
  const Example a(0);
  const Example b(1);
  const FragmentDetector detector = a.detector();
  const auto first = detector.detect(a.left, a.right);
  detector.detect(b.left, b.right);
  const auto again = detector.detect(a.left, a.right);
  ASSERT_EQ(first.size(), again.size());
  ASSERT_FALSE(first.empty());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].p_field, again[i].p_field);
    EXPECT_EQ(first[i].yaw, again[i].yaw);
  }
}

TEST(FragmentDetector, SeesNothingWhereThereIsNoPicture) {
  const Example example;
  const FragmentDetector detector = example.detector();
  for (const double level : {0.0, 128.0, 255.0}) {
    const cv::Mat blank(480, 640, CV_8UC3, cv::Scalar::all(level));
    EXPECT_TRUE(detector.detect(blank, blank).empty()) << level;
  }
  // All red: no tissue to compare with. And only one eye open.
  const cv::Mat red(480, 640, CV_8UC3, cv::Scalar(20, 20, 200));
  EXPECT_TRUE(detector.detect(red, red).empty());
  const cv::Mat blank(480, 640, CV_8UC3, cv::Scalar::all(90));
  EXPECT_TRUE(detector.detect(example.left, blank).empty());
  EXPECT_TRUE(detector.detect(blank, example.right).empty());
}

void expectWords(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << "said: " << text;
}

TEST(FragmentDetector, RefusesImagesThatAreNotThoseOfItsCameras) {
  const Example example;
  const FragmentDetector detector = example.detector();
  const auto detect = [&](const cv::Mat& left, const cv::Mat& right) {
    return complaint([&] { detector.detect(left, right); });
  };
  EXPECT_EQ(detect(example.left, example.right), "");
  expectWords(detect(cv::Mat(), example.right), "the left image is empty");
  expectWords(detect(example.left, cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(0))),
              "the right image is 320 x 240 px, but its camera was calibrated at 640 x 480");
  expectWords(detect(cv::Mat(480, 640, CV_8UC1, cv::Scalar::all(0)), example.right),
              "the left image has 1 channels");
  expectWords(detect(example.left, cv::Mat(480, 640, CV_16UC3, cv::Scalar::all(0))), "8 bits");
}

TEST(FragmentDetector, RefusesAConfigurationThatCannotBeMeant) {
  const Example example;
  const auto with = [&](double FragmentDetectorConfig::*field, double value) {
    FragmentDetectorConfig config;
    config.*field = value;
    return complaint([&] { example.detector(config); });
  };
  using C = FragmentDetectorConfig;
  expectWords(with(&C::field_width, 80.0), "are they in mm?");
  expectWords(with(&C::field_depth, std::numeric_limits<double>::quiet_NaN()), "field of");
  expectWords(with(&C::height_max, 0.0), "heights from");
  expectWords(with(&C::length_min, 0.02), "lengths from");
  expectWords(with(&C::thickness_max, 0.001), "thicknesses from");
  expectWords(with(&C::redness_min, 0.0), "redness_min");
  expectWords(with(&C::outline_noise, -1.0), "outline_noise");
}

TEST(FragmentDetector, RefusesACameraThatDoesNotSeeTheField) {
  const Example example;
  const auto at = [&](const Pose& X_field_camera) {
    return complaint([&] { FragmentDetector(example.scene.rig.camera, X_field_camera, {}); });
  };
  Pose X = example.scene.rig.X_field_camera;
  X.p.z() = -X.p.z();
  expectWords(at(X), "with z up?");
  X = example.scene.rig.X_field_camera;
  X.p.x() += 0.5;
  expectWords(at(X), "px of the field");
  X.q.coeffs() *= 2.0;
  expectWords(at(X), "quaternion");
  X.p.y() = std::numeric_limits<double>::quiet_NaN();
  expectWords(at(X), "not finite");
}

}  // namespace
}  // namespace raven_correction
