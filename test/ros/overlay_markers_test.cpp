// SPDX-License-Identifier: BSD-3-Clause
// Is every kind drawn in its own namespace, in mm and degrees, and taken away when it is over?
#include "raven_correction/ros/overlay_markers.h"

#include <gtest/gtest.h>

#include <set>

#include "raven_correction/CorrectionStatus.h"
#include "support/markers.h"

namespace raven_correction {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// A second in which the tool was seen 24.1 mm and 0.1 rad beside, then 1 mm.
OverlayHistory someHistory() {
  OverlayHistory history({});
  for (int k = 0; k < 200; ++k) {
    const double stamp = 1000.0 + 0.01 * k;
    const Pose wanted{{0.001 * k, 0.0, 0.0}, Eigen::Quaterniond::Identity()};
    Pose seen = wanted;
    seen.p.y() += k < 100 ? 0.0241 : 0.001;
    seen.q = expRotation({0.0, 0.1, 0.0});
    history.addStatus(stamp, k >= 100);
    history.addDesired({stamp, wanted});
    history.addCommand({stamp, wanted});
    history.addObserved({stamp, seen});
  }
  return history;
}

OverlayView fullView(const OverlayHistory& history) {
  OverlayView view;
  view.desired = view.command = history.desired().back().pose;
  view.observed = history.observed().back().pose;
  view.error = history.errors().front();
  view.sd_position = Eigen::Vector3d::Constant(0.001);
  view.workspace = OverlayBox{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
  view.status = {"mode full: corrected", "model m1"};
  return view;
}

TEST(OverlayMarkers, DrawEveryKindInItsOwnNamespaceWithAShapeOfItsOwn) {
  const OverlayHistory history = someHistory();
  const auto kinds = byNamespace(makeOverlay(fullView(history), history, {}));
  for (const char* ns : {"desired", "command", "observed", "labels", "error", "errors_uncorrected",
                         "errors_corrected", "trail_desired", "trail_command", "trail_observed",
                         "trail_error", "deviation", "workspace", "status"}) {
    ASSERT_TRUE(kinds.count(ns)) << ns;
    std::set<int> ids;
    for (const Marker& marker : kinds.at(ns)) {
      if (marker.ns != "status" && marker.ns != "trail_error") {  // as many as there are
        EXPECT_EQ(marker.action, Marker::ADD) << ns;
      }
      EXPECT_EQ(marker.header.frame_id, "0_link");
      EXPECT_GT(marker.lifetime.toSec(), 0.0);
      EXPECT_TRUE(ids.insert(marker.id).second) << ns;
      if (!marker.colors.empty()) {
        EXPECT_EQ(marker.colors.size(), marker.points.size()) << ns;
      }
    }
  }
  const std::set<int> origins{kinds.at("desired").back().type, kinds.at("command").back().type,
                              kinds.at("observed").back().type};
  EXPECT_EQ(origins.size(), 3u);  // not by colour alone
  const std::set<int> trails{kinds.at("trail_desired").back().type,
                             kinds.at("trail_command").back().type,
                             kinds.at("trail_observed").back().type};
  EXPECT_EQ(trails.size(), 3u);
}

TEST(OverlayMarkers, SayTheErrorInMillimetresAndDegrees) {
  const OverlayHistory history = someHistory();
  const auto kinds = byNamespace(makeOverlay(fullView(history), history, {}));
  ASSERT_EQ(kinds.at("error").size(), 3u);  // an arrow and two lines of text
  EXPECT_EQ(kinds.at("error")[1].text, "uncorrected error");
  EXPECT_EQ(kinds.at("error")[2].text, "24.10 mm, 5.73 deg");
  const Marker& arrow = kinds.at("error").front();
  ASSERT_EQ(arrow.points.size(), 2u);
  EXPECT_NEAR(arrow.points[1].y - arrow.points[0].y, 0.0241, 1e-12);  // from wanted to seen
  EXPECT_EQ(kinds.at("status")[0].text, "mode full: corrected");
  EXPECT_EQ(kinds.at("status")[1].text, "model m1");
  EXPECT_EQ(kinds.at("status")[2].action, Marker::DELETE);
}

TEST(OverlayMarkers, DeleteExactlyWhatTheyNoLongerShow) {
  const OverlayHistory history = someHistory();
  const MarkerArray full = makeOverlay(fullView(history), history, {});
  const MarkerArray empty = makeOverlay({}, OverlayHistory({}), {});
  ASSERT_EQ(full.markers.size(), empty.markers.size());
  for (std::size_t i = 0; i < full.markers.size(); ++i) {
    EXPECT_EQ(full.markers[i].ns, empty.markers[i].ns);
    EXPECT_EQ(full.markers[i].id, empty.markers[i].id);
    EXPECT_EQ(empty.markers[i].action, Marker::DELETE) << empty.markers[i].ns;
  }
}

TEST(OverlayMarkers, ColourTheTrailByItsError) {
  const OverlayHistory history = someHistory();
  const auto balls = byNamespace(makeOverlay(fullView(history), history, {})).at("trail_error");
  ASSERT_EQ(balls.size(), 4u + 5u);  // classes, then the legend
  std::size_t count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double smaller = k > 0 ? balls[k - 1].scale.x : 0.0;
    EXPECT_GT(balls[k].scale.x, smaller);  // not by colour alone
    count += balls[k].points.size();
    for (const auto& p : balls[k].points) EXPECT_EQ(k, p.y > 0.02 ? 3u : 0u);
  }
  EXPECT_EQ(count, history.errors().size());
  EXPECT_EQ(balls[5].text, "smallest balls: 0 to 5 mm");
  EXPECT_EQ(balls[8].text, "largest balls: above 15 mm");
}

TEST(OverlayMarkers, DrawTwoSigmaAboutTheCommand) {
  const OverlayHistory history = someHistory();
  OverlayView view = fullView(history);
  view.sd_position.reset();
  EXPECT_EQ(byNamespace(makeOverlay(view, history, {})).at("deviation")[0].action, Marker::DELETE);
  view.sd_position = Eigen::Vector3d(0.001, 0.002, 0.003);
  const auto deviation = byNamespace(makeOverlay(view, history, {})).at("deviation");
  EXPECT_NEAR(deviation[0].scale.y, 4.0 * 0.002, 1e-12);  // a diameter
  EXPECT_EQ(deviation[0].pose.position.x, view.command->p.x());
  EXPECT_EQ(deviation[1].text, "2 sigma: 2.0, 4.0, 6.0 mm");
}

TEST(OverlayMarkers, SayByHowMuchErrorsAreExaggerated) {
  const OverlayHistory history = someHistory();
  OverlayStyle style;
  style.exaggeration = 3.0;
  const auto error = byNamespace(makeOverlay(fullView(history), history, style)).at("error");
  EXPECT_NEAR(error[0].points[1].y - error[0].points[0].y, 3.0 * 0.0241, 1e-12);
  EXPECT_EQ(error[1].text, "uncorrected error, drawn 3 times as long");
  EXPECT_EQ(error[2].text, "24.10 mm, 5.73 deg");
}

TEST(OverlayMarkers, NameEveryCode) {
  std::set<std::string> names;
  for (int code = 0; code <= CorrectionStatus::REFUSED_UNREACHABLE; ++code) {
    if (code > CorrectionStatus::PASSED_OTHER_PUBLISHER &&
        code < CorrectionStatus::REFUSED_NOT_FINITE)
      continue;  // no code of ours
    const std::string name = correctionCodeName(static_cast<std::uint8_t>(code));
    EXPECT_NE(name, "unknown") << code;
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_EQ(correctionCodeName(CorrectionStatus::CORRECTED_FADED), "corrected faded");
  EXPECT_EQ(correctionCodeName(CorrectionStatus::PASSED_OTHER_PUBLISHER), "passed other publisher");
  EXPECT_EQ(correctionCodeName(CorrectionStatus::REFUSED_STALE), "REFUSED stale");
  EXPECT_TRUE(isCorrectedCode(CorrectionStatus::RIGID_ONLY));
  EXPECT_FALSE(isCorrectedCode(CorrectionStatus::PASSED_OFF));
}

}  // namespace
}  // namespace raven_correction
