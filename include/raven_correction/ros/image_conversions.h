// SPDX-License-Identifier: BSD-3-Clause
// Between images and calibrations of ROS and the types of the core. Poses and joints are
// conversions.h.
#pragma once

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "raven_correction/FragmentArray.h"
#include "raven_correction/geometry/stereo_camera.h"
#include "raven_correction/perception/fragment_detector.h"
#include "raven_correction/simulation/stereo_renderer.h"

namespace raven_correction {

/// @param name  of the camera, for messages
/// @throws InvalidInput  another lens model than plumb_bob, a wrong number of coefficients, binning
///         or a region of interest (the images are not those that were calibrated)
PinholeCamera cameraFromMsg(const sensor_msgs::CameraInfo& info, const char* name);
/// @throws InvalidInput  see cameraFromMsg() and checkStereoCamera()
StereoCamera stereoCameraFromMsgs(const sensor_msgs::CameraInfo& left,
                                  const sensor_msgs::CameraInfo& right);
sensor_msgs::CameraInfo cameraToMsg(const PinholeCamera& camera, const std_msgs::Header& header);

/// As bgr8; shares the message's memory where it is that already.
/// @throws InvalidInput  an encoding that has no colours, or data of another size than it says
cv_bridge::CvImageConstPtr imageFromMsg(const sensor_msgs::ImageConstPtr& msg, const char* name);
sensor_msgs::ImagePtr imageToMsg(const ColourImage& image, const std_msgs::Header& header);

Fragment fragmentToMsg(const FragmentDetection& detection);

}  // namespace raven_correction
