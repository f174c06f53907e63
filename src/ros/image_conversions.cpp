// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/image_conversions.h"

#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"

namespace raven_correction {
namespace {

using RowMatrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMatrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

}  // namespace

PinholeCamera cameraFromMsg(const sensor_msgs::CameraInfo& info, const char* name) {
  if (info.distortion_model != sensor_msgs::distortion_models::PLUMB_BOB)
    throw InvalidInput(
        format("%s camera_info: distortion model '%s', must be plumb_bob; calibrate with five "
               "coefficients, or publish rectified images with zeros",
               name, info.distortion_model.c_str()));
  if (info.D.size() != 5)
    throw InvalidInput(
        format("%s camera_info: %zu distortion coefficients, plumb_bob has 5 (k1, k2, p1, p2, k3)",
               name, info.D.size()));
  const auto& roi = info.roi;
  const bool whole = roi.x_offset == 0 && roi.y_offset == 0 &&
                     (roi.width == 0 || roi.width == info.width) &&
                     (roi.height == 0 || roi.height == info.height);
  if (info.binning_x > 1 || info.binning_y > 1 || !whole)
    throw InvalidInput(format(
        "%s camera_info: binning %u x %u, region of interest %u x %u at (%u, %u); only whole "
        "images at the size of the calibration are understood",
        name, info.binning_x, info.binning_y, roi.width, roi.height, roi.x_offset, roi.y_offset));
  PinholeCamera camera;
  camera.width = static_cast<int>(info.width);
  camera.height = static_cast<int>(info.height);
  camera.K = Eigen::Map<const RowMatrix3>(info.K.data());
  camera.D = Eigen::Map<const Eigen::Matrix<double, 5, 1>>(info.D.data());
  camera.R = Eigen::Map<const RowMatrix3>(info.R.data());
  camera.P = Eigen::Map<const RowMatrix34>(info.P.data());
  return camera;
}

StereoCamera stereoCameraFromMsgs(const sensor_msgs::CameraInfo& left,
                                  const sensor_msgs::CameraInfo& right) {
  const StereoCamera camera{cameraFromMsg(left, "left"), cameraFromMsg(right, "right")};
  checkStereoCamera(camera);
  return camera;
}

sensor_msgs::CameraInfo cameraToMsg(const PinholeCamera& camera, const std_msgs::Header& header) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(camera.D.data(), camera.D.data() + camera.D.size());
  Eigen::Map<RowMatrix3>(info.K.data()) = camera.K;
  Eigen::Map<RowMatrix3>(info.R.data()) = camera.R;
  Eigen::Map<RowMatrix34>(info.P.data()) = camera.P;
  return info;
}

cv_bridge::CvImageConstPtr imageFromMsg(const sensor_msgs::ImageConstPtr& msg, const char* name) {
  namespace encodings = sensor_msgs::image_encodings;
  const std::string& encoding = msg->encoding;
  // Bayer patterns and YUV are colours, too; cv_bridge knows how they become bgr8.
  if (encoding.empty() || encodings::isMono(encoding))
    throw InvalidInput(
        format("%s image: encoding '%s' has no colours, and fragments are found by theirs; "
               "subscribe to a colour topic, e.g. image_raw of a colour camera",
               name, encoding.c_str()));
  if (static_cast<std::size_t>(msg->step) * msg->height != msg->data.size())
    throw InvalidInput(format("%s image: %zu bytes, but %u rows of %u", name, msg->data.size(),
                              msg->height, msg->step));
  try {
    return cv_bridge::toCvShare(msg, encodings::BGR8);
  } catch (const cv_bridge::Exception& error) {
    throw InvalidInput(format("%s image: encoding '%s' does not become bgr8: %s", name,
                              encoding.c_str(), error.what()));
  }
}

sensor_msgs::ImagePtr imageToMsg(const ColourImage& image, const std_msgs::Header& header) {
  const sensor_msgs::ImagePtr msg(new sensor_msgs::Image);
  msg->header = header;
  msg->width = static_cast<std::uint32_t>(image.width);
  msg->height = static_cast<std::uint32_t>(image.height);
  msg->encoding = sensor_msgs::image_encodings::BGR8;
  msg->step = 3 * msg->width;
  msg->data = image.bgr;
  return msg;
}

Fragment fragmentToMsg(const FragmentDetection& detection) {
  Fragment msg;
  msg.position = pointToMsg(detection.p_field);
  Eigen::Map<RowMatrix3>(msg.covariance.data()) = detection.covariance;
  msg.yaw = detection.yaw;
  msg.yaw_deviation = detection.yaw_deviation;
  msg.length = detection.length;
  msg.width = detection.width;
  msg.top = detection.top;
  msg.partly_hidden = detection.partly_hidden;
  return msg;
}

}  // namespace raven_correction
