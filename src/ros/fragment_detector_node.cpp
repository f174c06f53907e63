// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/fragment_detector_node.h"

#include <geometry_msgs/PoseArray.h>

#include <cmath>

#include "raven_correction/FragmentArray.h"
#include "raven_correction/error.h"
#include "raven_correction/perception/detection_drawing.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/image_conversions.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kWarningPeriod = 5.0;  // [s]
constexpr int kQueue = 3;               // pairs; older ones are of no use

bool sameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b) {
  return a.width == b.width && a.height == b.height && a.D == b.D && a.K == b.K && a.R == b.R &&
         a.P == b.P && a.distortion_model == b.distortion_model && a.binning_x == b.binning_x &&
         a.binning_y == b.binning_y && a.roi == b.roi;
}

}  // namespace

FragmentDetectorParams loadFragmentDetectorParams(const ros::NodeHandle& nh) {
  FragmentDetectorParams params;
  FragmentDetectorConfig& config = params.detector;
  ParamReader read(nh, "fragment_detector");
  read.text("field_frame", params.field_frame);
  read.number("field_width", config.field_width, 0.005, 1.0);
  read.number("field_depth", config.field_depth, 0.005, 1.0);
  read.number("height_min", config.height_min, -0.01, 0.1);
  read.number("height_max", config.height_max, 0.0, 0.1);
  read.positive("length_min", config.length_min, 0.1);
  read.positive("length_max", config.length_max, 0.1);
  read.positive("thickness_min", config.thickness_min, 0.1);
  read.positive("thickness_max", config.thickness_max, 0.1);
  read.positive("redness_min", config.redness_min, 2.9);
  read.positive("outline_noise", config.outline_noise, 10.0);
  read.number("shape_noise", config.shape_noise, 0.0, 1.0);
  if (config.height_max <= config.height_min)
    read.problem("height_max", format("%g m is not above height_min = %g m", config.height_max,
                                      config.height_min));
  if (config.length_max <= config.length_min)
    read.problem("length_max", format("%g m is not above length_min = %g m", config.length_max,
                                      config.length_min));
  read.refuseUnknownKeys();
  read.throwIfAnyProblem();
  params.field_frame = withoutSlash(params.field_frame);
  if (params.field_frame.empty())
    throw InvalidInput(
        "fragment_detector: ~field_frame is empty; give the frame in which fragments "
        "are wanted, with its origin on the platform and z up");
  ROS_INFO_STREAM(read.summary());
  return params;
}

FragmentDetectorNode::FragmentDetectorNode(const ros::NodeHandle& nh,
                                           const ros::NodeHandle& private_nh,
                                           const FragmentDetectorParams& params)
    : params_(params),
      field_(params.field_frame),
      nh_(nh),
      diagnostics_(nh, private_nh),
      left_(nh_, topics::kLeftImage, kQueue),
      right_(nh_, topics::kRightImage, kQueue),
      left_calibration_(nh_, topics::kLeftInfo, kQueue),
      right_calibration_(nh_, topics::kRightInfo, kQueue),
      sync_(left_, left_calibration_, right_, right_calibration_, kQueue) {
  fragments_ = nh_.advertise<FragmentArray>(topics::kFragments, 2);
  poses_ = nh_.advertise<geometry_msgs::PoseArray>(topics::kFragmentPoses, 2);
  image_ = nh_.advertise<sensor_msgs::Image>(topics::kFragmentImage, 2);
  diagnostics_.setHardwareID("stereo camera");
  diagnostics_.add("fragments", this, &FragmentDetectorNode::report);
  diagnostics_timer_ = nh_.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.update(); });
  ROS_INFO("fragment_detector: listens to %s, %s and their camera_info, publishes %s in frame %s",
           left_.getTopic().c_str(), right_.getTopic().c_str(), fragments_.getTopic().c_str(),
           params_.field_frame.c_str());
  sync_.registerCallback(&FragmentDetectorNode::onPair, this);
}

const FragmentDetector& FragmentDetectorNode::detectorFor(const sensor_msgs::CameraInfo& left,
                                                          const sensor_msgs::CameraInfo& right) {
  const std::string frame = withoutSlash(left.header.frame_id);
  const std::optional<Pose> X_field_camera = field_.find(frame);
  if (!X_field_camera)
    throw InvalidInput(
        format("tf does not connect the camera's frame '%s' with '%s'; publish where the camera "
               "stands, e.g. with tf2_ros static_transform_publisher",
               frame.c_str(), params_.field_frame.c_str()));
  const bool same_place = (X_field_camera->p - X_field_camera_.p).norm() < 1e-9 &&
                          rotationAngle(X_field_camera->q, X_field_camera_.q) < 1e-7;
  if (detector_ && same_place && sameCalibration(left, left_info_) &&
      sameCalibration(right, right_info_))
    return *detector_;
  detector_.reset();
  detector_.emplace(stereoCameraFromMsgs(left, right), *X_field_camera, params_.detector);
  left_info_ = left;
  right_info_ = right;
  X_field_camera_ = *X_field_camera;
  return *detector_;
}

void FragmentDetectorNode::onPair(const sensor_msgs::ImageConstPtr& left,
                                  const sensor_msgs::CameraInfoConstPtr& left_info,
                                  const sensor_msgs::ImageConstPtr& right,
                                  const sensor_msgs::CameraInfoConstPtr& right_info) {
  ++pairs_;
  try {
    const ros::SteadyTime begin = ros::SteadyTime::now();
    const FragmentDetector& detector = detectorFor(*left_info, *right_info);
    FragmentDetectorTrace trace;
    const std::vector<FragmentDetection> fragments = detector.detect(
        imageFromMsg(left, "left")->image, imageFromMsg(right, "right")->image, &trace);
    duration_ = (ros::SteadyTime::now() - begin).toSec();
    found_ = fragments.size();
    problem_.clear();
    publish(left->header, fragments, trace.left);
  } catch (const InvalidInput& error) {
    ++refused_;
    problem_ = error.what();
    ROS_WARN_THROTTLE(kWarningPeriod, "fragment_detector: a pair of images was not used: %s",
                      error.what());
  }
}

void FragmentDetectorNode::publish(const std_msgs::Header& images,
                                   const std::vector<FragmentDetection>& fragments,
                                   const cv::Mat& rectified) {
  FragmentArray msg;
  msg.header.stamp = images.stamp;
  msg.header.frame_id = params_.field_frame;
  geometry_msgs::PoseArray poses;
  poses.header = msg.header;
  for (const FragmentDetection& fragment : fragments) {
    msg.fragments.push_back(fragmentToMsg(fragment));
    poses.poses.push_back(poseToMsg({fragment.p_field, expRotation({0.0, 0.0, fragment.yaw})}));
  }
  fragments_.publish(msg);
  poses_.publish(poses);
  if (image_.getNumSubscribers() == 0) return;
  cv_bridge::CvImage drawn(images, "bgr8", rectified.clone());
  drawDetections(fragments, drawn.image);
  image_.publish(drawn.toImageMsg());
}

void FragmentDetectorNode::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!problem_.empty())
    status.summary(DiagnosticStatus::WARN, problem_);
  else
    status.summaryf(DiagnosticStatus::OK, "%zu fragments", found_);
  status.add("pairs of images", pairs_);
  status.add("not used", refused_);
  status.addf("time for the last pair [ms]", "%.1f", 1e3 * duration_);
}

}  // namespace raven_correction
