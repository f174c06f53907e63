// SPDX-License-Identifier: BSD-3-Clause
// Does rviz get what the topics say, and does it go away when the topics fall silent?
#include "raven_correction/ros/overlay.h"

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <visualization_msgs/MarkerArray.h>

#include <cmath>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/ros/conversions.h"
#include "support/node_main.h"
#include "support/spin_until.h"

namespace raven_correction {
namespace {

using visualization_msgs::Marker;

constexpr double kLimit = 15.0;  // [s]

class OverlayNode : public testing::Test {
 protected:
  OverlayNode() : nh("/raven/left") {
    subscriber = nh.subscribe<visualization_msgs::MarkerArray>(
        "overlay", 10, [this](const auto& message) { latest = *message; });
  }
  template <typename Condition>
  bool until(Condition condition) {
    return spinUntil(condition, kLimit);
  }
  /// The last marker of a namespace that is shown.
  const Marker* shown(const std::string& ns) const {
    const Marker* last = nullptr;
    for (const Marker& marker : latest.markers)
      if (marker.ns == ns && marker.action == Marker::ADD) last = &marker;
    return last;
  }
  bool says(const std::string& ns, const std::string& words) const {
    for (const Marker& marker : latest.markers)
      if (marker.ns == ns && marker.action == Marker::ADD &&
          marker.text.find(words) != std::string::npos)
        return true;
    return false;
  }

  ros::NodeHandle nh;
  ros::Subscriber subscriber;
  visualization_msgs::MarkerArray latest;
};

TEST_F(OverlayNode, ShowsTheErrorInBaseAndForgetsItWhenTheTopicsFallSilent) {
  const Pose X_base_mocap{{0.087, 1.778, -0.770}, expRotation({0.1, -0.4, 1.2})};
  geometry_msgs::TransformStamped registration;
  registration.header.stamp = ros::Time::now();
  registration.header.frame_id = "0_link";
  registration.child_frame_id = "mocap";
  registration.transform = transformToMsg(X_base_mocap);
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(registration);
  auto desired = nh.advertise<geometry_msgs::PoseStamped>("desired/servo_cp", 10);
  auto seen = nh.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp", 10);
  auto status = nh.advertise<CorrectionStatus>("correction/status", 10);
  auto model = nh.advertise<CorrectionModel>("correction/model", 1, true);
  CorrectionModel trained;
  trained.id = "model-1";
  trained.workspace_min.x = trained.workspace_min.y = trained.workspace_min.z = -0.1;
  trained.workspace_max.x = trained.workspace_max.y = trained.workspace_max.z = 0.1;
  model.publish(trained);

  const Pose wanted{{0.01, 0.02, -0.03}, expRotation({0.0, 0.0, 0.3})};
  const Pose tool{wanted.p + Eigen::Vector3d(0.003, 0.0, 0.004),
                  wanted.q * expRotation({2.0 * M_PI / 180.0, 0.0, 0.0})};
  CorrectionStatus off;
  off.mode = "off";
  off.code = CorrectionStatus::PASSED_OFF;
  int k = 0;
  const auto publishAndSeeError = [&] {
    const double now = ros::Time::now().toSec();
    Pose trembling = tool;  // a pose that repeats itself would be a frozen frame
    trembling.p.x() += 1e-9 * k++;
    desired.publish(stampedPoseToMsg(now, wanted, "0_link"));
    seen.publish(stampedPoseToMsg(now, X_base_mocap.inverse() * trembling, "mocap"));
    off.header.stamp.fromSec(now);
    status.publish(off);
    return shown("error") != nullptr && shown("workspace") != nullptr &&
           says("status", "mode off: passed off");
  };
  ASSERT_TRUE(until(publishAndSeeError));
  EXPECT_TRUE(says("error", "uncorrected error"));
  EXPECT_EQ(shown("error")->text, "5.00 mm, 2.00 deg");
  EXPECT_TRUE(says("status", "model model-1"));
  ASSERT_NE(shown("observed"), nullptr);
  EXPECT_NEAR(shown("observed")->pose.position.z, -0.026, 1e-6);
  EXPECT_EQ(shown("command"), nullptr);  // nobody sends one

  EXPECT_TRUE(until([&] {
    return shown("error") == nullptr && shown("desired") == nullptr && shown("observed") == nullptr;
  }));
  EXPECT_TRUE(until([&] { return says("status", "corrector: silent"); }));
}

TEST_F(OverlayNode, SaysWhatTfDoesNotKnow) {
  auto seen = nh.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp", 10);
  EXPECT_TRUE(until([&] {
    seen.publish(stampedPoseToMsg(ros::Time::now().toSec(), Pose{}, "somewhere"));
    return says("status", "tf does not know somewhere in 0_link");
  }));
}

TEST(OverlayParameters, AreThoseOfTheShippedFile) {
  const OverlayParams shipped = loadOverlayParams(ros::NodeHandle("/shipped"));
  const OverlayParams defaults = loadOverlayParams(ros::NodeHandle("/empty"));
  EXPECT_EQ(shipped.base_frame, defaults.base_frame);
  EXPECT_EQ(shipped.rate, defaults.rate);
  EXPECT_EQ(shipped.max_age, defaults.max_age);
  EXPECT_EQ(shipped.history.delay, defaults.history.delay);
  EXPECT_EQ(shipped.history.trail_duration, defaults.history.trail_duration);
  EXPECT_EQ(shipped.history.error_duration, defaults.history.error_duration);
  EXPECT_EQ(shipped.history.error_period, defaults.history.error_period);
  EXPECT_EQ(shipped.style.axis_length, defaults.style.axis_length);
  EXPECT_EQ(shipped.style.text_height, defaults.style.text_height);
  EXPECT_EQ(shipped.style.exaggeration, defaults.style.exaggeration);
  EXPECT_EQ(shipped.style.error_scale, defaults.style.error_scale);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_overlay");
}
