// SPDX-License-Identifier: BSD-3-Clause
// Are samples, reasons, hull and error field drawn each for itself, where they are and how they
// are?
#include "raven_correction/ros/training_markers.h"

#include <gtest/gtest.h>

#include "raven_correction/ros/conversions.h"
#include "support/markers.h"
#include "support/simple_model.h"

namespace raven_correction {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

TrainingSamples someSamples() {
  TrainingSamples samples;
  for (int corner = 0; corner < 8; ++corner)
    samples.kept.push_back(
        pointToMsg({corner & 1 ? 0.1 : 0.0, corner & 2 ? 0.1 : 0.0, corner & 4 ? 0.1 : 0.0}));
  samples.kept.push_back(pointToMsg({0.05, 0.05, 0.05}));
  samples.reason_names = {"speed", "rotation_window"};
  samples.reason_counts = {20, 1};
  samples.rejected = {pointToMsg({0.2, 0.0, 0.0}), pointToMsg({0.3, 0.0, 0.1}),
                      pointToMsg({0.4, 0.0, 0.0})};
  samples.reasons = {0, 0, 1};
  return samples;
}

TEST(TrainingMarkers, DrawSamplesAndReasonsEachInANamespace) {
  const TrainingSamples samples = someSamples();
  const MarkerArray array = makeTrainingMarkers(&samples, nullptr, {});
  EXPECT_EQ(array.markers.front().action, Marker::DELETEALL);
  auto kinds = byNamespace(array);
  EXPECT_EQ(kinds.at("samples_kept").front().points.size(), 9u);
  ASSERT_EQ(kinds.at("rejected_speed").size(), 2u);
  EXPECT_EQ(kinds.at("rejected_speed")[0].points.size(), 2u);
  EXPECT_NE(kinds.at("rejected_speed")[0].type, kinds.at("samples_kept")[0].type);
  EXPECT_EQ(kinds.at("rejected_speed")[1].text, "rejected: speed, 20");
  EXPECT_GT(kinds.at("rejected_speed")[1].pose.position.z, 0.1);  // above its highest
  EXPECT_EQ(kinds.at("rejected_rotation_window")[0].points.size(), 1u);
  EXPECT_EQ(kinds.count("error_field"), 0u);
  for (const Marker& marker : array.markers) EXPECT_EQ(marker.lifetime.toSec(), 0.0);
}

TEST(TrainingMarkers, HullHasTheCornersOnly) {
  const TrainingSamples samples = someSamples();
  const auto hull = byNamespace(makeTrainingMarkers(&samples, nullptr, {})).at("trained_hull");
  ASSERT_EQ(hull.size(), 2u);
  EXPECT_EQ(hull[0].points.size(), 3u * 12u);  // a cube: two triangles on each side
  EXPECT_EQ(hull[1].points.size(), 6u * 12u);
  for (const auto& p : hull[0].points) EXPECT_TRUE(p.x == 0.0 || p.x == 0.1) << p.x;
}

TEST(TrainingMarkers, FieldIsWhatTheModelAddsAtRest) {
  const Predictor predictor(simpleModel());
  OverlayStyle style;
  style.exaggeration = 2.0;
  const auto field = byNamespace(makeTrainingMarkers(nullptr, &predictor, style)).at("error_field");
  ASSERT_EQ(field.size(), 3u);  // trusted, faded, what it is
  std::size_t points = 0;
  for (const Marker& marker : {field[0], field[1]})
    if (marker.action == Marker::ADD) points += marker.points.size();
  EXPECT_EQ(points, 6u * 5u * 5u * 3u);
  ASSERT_EQ(field[0].action, Marker::ADD);
  const auto workspace = predictor.makeWorkspace();
  Motion rest;
  rest.pose.q = predictor.model().rigid.q.conjugate() * predictor.model().mean_orientation;
  rest.pose.p = {field[0].points[0].x, field[0].points[0].y, field[0].points[0].z};
  const Prediction said = predictor.predict(rest, *workspace);
  EXPECT_GT(said.h_share, 0.999);
  const Eigen::Vector3d tip(field[0].points[1].x, field[0].points[1].y, field[0].points[1].z);
  EXPECT_LT((tip - rest.pose.p - 2.0 * (said.command.p - rest.pose.p)).norm(), 1e-12);
  EXPECT_NE(field[2].text.find("drawn 2 times as long"), std::string::npos);
}

TEST(TrainingMarkers, WithoutAnythingDeleteWhatWasThere) {
  const MarkerArray array = makeTrainingMarkers(nullptr, nullptr, {});
  ASSERT_EQ(array.markers.size(), 1u);
  EXPECT_EQ(array.markers[0].action, Marker::DELETEALL);
}

}  // namespace
}  // namespace raven_correction
