// SPDX-License-Identifier: BSD-3-Clause
// Calibrations and images to messages and back, and what is wrong with others' messages.
#include "raven_correction/ros/image_conversions.h"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <string>

#include "raven_correction/error.h"
#include "raven_correction/simulation/stereo_rig.h"
#include "support/complaint.h"

namespace raven_correction {
namespace {

TEST(CameraInfo, GoesThereAndBack) {
  const StereoCamera camera = makeStereoRig({}).camera;
  const StereoCamera back =
      stereoCameraFromMsgs(cameraToMsg(camera.left, {}), cameraToMsg(camera.right, {}));
  for (const auto& [a, b] : {std::pair{&camera.left, &back.left}, {&camera.right, &back.right}}) {
    EXPECT_EQ(a->width, b->width);
    EXPECT_EQ(a->height, b->height);
    EXPECT_EQ(a->K, b->K);
    EXPECT_EQ(a->D, b->D);
    EXPECT_EQ(a->R, b->R);
    EXPECT_EQ(a->P, b->P);
  }
  // Row by row, as CameraInfo.msg says.
  const sensor_msgs::CameraInfo info = cameraToMsg(camera.right, {});
  EXPECT_EQ(info.K[2], camera.right.K(0, 2));
  EXPECT_EQ(info.P[3], camera.right.P(0, 3));
  EXPECT_EQ(info.distortion_model, "plumb_bob");
}

TEST(CameraInfo, SaysWhatIsNotUnderstood) {
  const StereoCamera camera = makeStereoRig({}).camera;
  const sensor_msgs::CameraInfo good = cameraToMsg(camera.left, {});
  sensor_msgs::CameraInfo info = good;
  const auto said = [&] { return complaint([&] { cameraFromMsg(info, "left"); }); };
  EXPECT_EQ(said(), "");
  info.distortion_model = "rational_polynomial";
  EXPECT_NE(said().find("must be plumb_bob"), std::string::npos);
  info = good;
  info.D.clear();
  EXPECT_NE(said().find("0 distortion coefficients"), std::string::npos);
  info = good;
  info.roi.width = 320;
  EXPECT_NE(said().find("region of interest 320 x 0"), std::string::npos);
  info = good;
  info.roi.width = info.width;  // the whole image, said in another way
  info.roi.height = info.height;
  EXPECT_EQ(said(), "");
  info.K.fill(0.0);  // not calibrated
  EXPECT_NE(complaint([&] { stereoCameraFromMsgs(info, info); }).find("not calibrated"),
            std::string::npos);
}

TEST(Image, GoesThereAndBackWithoutACopy) {
  ColourImage image{4, 3, {}};
  for (int i = 0; i < 36; ++i) image.bgr.push_back(static_cast<std::uint8_t>(7 * i));
  const sensor_msgs::ImagePtr msg = imageToMsg(image, {});
  const auto back = imageFromMsg(msg, "left");
  ASSERT_EQ(back->image.cols, 4);
  ASSERT_EQ(back->image.rows, 3);
  EXPECT_EQ(back->image.data, msg->data.data());
  EXPECT_EQ(back->image.at<cv::Vec3b>(2, 1)[2], image.bgr[3 * (2 * 4 + 1) + 2]);
}

TEST(Image, TurnsOtherColoursAndRefusesNone) {
  const auto msg = boost::make_shared<sensor_msgs::Image>();
  msg->width = msg->height = 2;
  msg->step = 6;
  msg->encoding = "rgb8";
  msg->data.assign(12, 0);
  msg->data[0] = 200;  // red of the first pixel
  EXPECT_EQ(imageFromMsg(msg, "left")->image.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 200));
  const auto said = [&] { return complaint([&] { imageFromMsg(msg, "right"); }); };
  msg->data.resize(11);
  EXPECT_NE(said().find("right image: 11 bytes"), std::string::npos);
  msg->step = 2;
  msg->data.resize(4);
  msg->encoding = "mono8";
  EXPECT_NE(said().find("has no colours"), std::string::npos);
  msg->encoding = "";
  EXPECT_NE(said().find("has no colours"), std::string::npos);
  msg->encoding = "what is this";
  EXPECT_NE(said(), "");
}

}  // namespace
}  // namespace raven_correction
