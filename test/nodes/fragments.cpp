// SPDX-License-Identifier: BSD-3-Clause
// From images on topics to fragments in the frame of the field, and what becomes of images that
// cannot be used.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <cmath>

#include "raven_correction/FragmentArray.h"
#include "raven_correction/ros/image_conversions.h"
#include "raven_correction/simulation/stereo_rig.h"
#include "support/node_main.h"
#include "support/spin_until.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 30.0;  // [s]

template <typename Condition>
bool until(Condition condition) {
  return spinUntil(condition, kLimit);
}

double distance(const Fragment& a, const Fragment& b) {
  return std::sqrt(std::pow(a.position.x - b.position.x, 2) +
                   std::pow(a.position.y - b.position.y, 2) +
                   std::pow(a.position.z - b.position.z, 2));
}

TEST(Fragments, FindsTheFragmentsOfOneSceneAfterAnother) {
  ros::NodeHandle nh("/field_camera");
  FragmentArray found, truth;
  std::size_t drawn = 0;
  const auto s1 = nh.subscribe<FragmentArray>("fragments", 5, [&](const auto& m) { found = *m; });
  const auto s2 =
      nh.subscribe<FragmentArray>("simulator/truth", 5, [&](const auto& m) { truth = *m; });
  const auto s3 = nh.subscribe<sensor_msgs::Image>("fragments/image", 2,
                                                   [&](const auto& m) { drawn = m->data.size(); });
  auto next = nh.serviceClient<std_srvs::Trigger>("simulator/next_scene");
  ASSERT_TRUE(next.waitForExistence(ros::Duration(kLimit)));
  for (int scene = 0; scene < 3; ++scene) {
    const auto found_all = [&] {
      if (truth.fragments.empty() || found.header.stamp <= truth.header.stamp) return false;
      for (const Fragment& fragment : truth.fragments) {
        if (fragment.partly_hidden) continue;
        bool near = false;
        for (const Fragment& detection : found.fragments)
          near = near || distance(fragment, detection) < 1.5e-3;
        if (!near) return false;
      }
      return true;
    };
    EXPECT_TRUE(until(found_all)) << "scene " << scene << ": " << truth.fragments.size()
                                  << " fragments, detected " << found.fragments.size();
    EXPECT_EQ(found.header.frame_id, "field");
    for (const Fragment& detection : found.fragments) {
      EXPECT_GT(detection.covariance[0], 0.0);
      EXPECT_LT(std::sqrt(detection.covariance[8]), 5e-3);
      EXPECT_GE(detection.length, detection.width);
    }
    std_srvs::Trigger trigger;
    const ros::Time before = truth.header.stamp;
    ASSERT_TRUE(next.call(trigger));
    ASSERT_TRUE(until([&] { return truth.header.stamp > before; }));
  }
  EXPECT_TRUE(until([&] { return drawn == 640u * 480u * 3u; }));
}

/// A driver in another namespace, whose messages are made by hand.
struct Driver {
  Driver() {
    left_image = nh.advertise<sensor_msgs::Image>("left/image_raw", 2);
    left_info = nh.advertise<sensor_msgs::CameraInfo>("left/camera_info", 2);
    right_image = nh.advertise<sensor_msgs::Image>("right/image_raw", 2);
    right_info = nh.advertise<sensor_msgs::CameraInfo>("right/camera_info", 2);
    const StereoRig rig = makeStereoRig({});
    std_msgs::Header header;
    header.frame_id = "field_camera";  // known by the simulated camera
    left = cameraToMsg(rig.camera.left, header);
    right = cameraToMsg(rig.camera.right, header);
    image = *imageToMsg({640, 480, std::vector<std::uint8_t>(640 * 480 * 3, 100)}, header);
  }
  /// Every 20th time it is asked.
  void sendNowAndThen() {
    if (asked++ % 20 != 0) return;
    const ros::Time now = ros::Time::now();
    left.header.stamp = right.header.stamp = image.header.stamp = now;
    left_image.publish(image);
    right_image.publish(image);
    left_info.publish(left);
    right_info.publish(right);
  }
  ros::NodeHandle nh{"/broken"};
  ros::Publisher left_image, left_info, right_image, right_info;
  sensor_msgs::CameraInfo left, right;
  sensor_msgs::Image image;
  int asked = 0;
};

TEST(Fragments, SaysWhyAPairOfImagesIsNotUsedAndGoesOn) {
  Driver driver;
  std::string said;
  int answers = 0;
  const auto s1 =
      driver.nh.subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", 20, [&](const auto& m) {
        for (const auto& status : m->status)
          if (status.name.find("broken") != std::string::npos) said = status.message;
      });
  const auto s2 =
      driver.nh.subscribe<FragmentArray>("fragments", 5, [&](const auto&) { ++answers; });
  const auto complains = [&](const std::string& words) {
    return until([&] {
      driver.sendNowAndThen();
      return said.find(words) != std::string::npos;
    });
  };
  ASSERT_TRUE(until([&] { return driver.left_image.getNumSubscribers() > 0; }));
  const Driver good;

  driver.left.distortion_model = "equidistant";
  EXPECT_TRUE(complains("must be plumb_bob")) << said;
  driver.left = good.left;
  driver.right.D.resize(8);
  EXPECT_TRUE(complains("8 distortion coefficients")) << said;
  driver.right = good.right;
  driver.right.binning_x = 2;
  EXPECT_TRUE(complains("binning")) << said;
  driver.right = good.right;
  std::swap(driver.left.P, driver.right.P);
  EXPECT_TRUE(complains("swapped")) << said;
  driver.left = good.left;
  driver.right = good.right;
  driver.left.header.frame_id = "nowhere";
  EXPECT_TRUE(complains("tf does not connect")) << said;
  driver.left = good.left;
  driver.image.encoding = "mono8";
  driver.image.step = 640;
  driver.image.data.resize(640 * 480);
  EXPECT_TRUE(complains("has no colours")) << said;
  driver.image = good.image;
  driver.image.height = 240;
  driver.image.data.resize(640 * 240 * 3);
  EXPECT_TRUE(complains("640 x 240 px")) << said;
  driver.image.data.resize(7);
  EXPECT_TRUE(complains("7 bytes")) << said;
  EXPECT_EQ(answers, 0);

  driver.image = good.image;
  EXPECT_TRUE(until([&] {
    driver.sendNowAndThen();
    return answers > 0;
  }));
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_fragments");
}
