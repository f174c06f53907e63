// SPDX-License-Identifier: BSD-3-Clause
// The node `fragment_detector`: from the images of a stereo camera to the fragments on the field,
// in the frame of the field. What it computes is perception/fragment_detector.h.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <optional>
#include <string>

#include "raven_correction/perception/fragment_detector.h"
#include "raven_correction/ros/registration.h"

namespace raven_correction {

struct FragmentDetectorParams {
  std::string field_frame = "field";  ///< tf connects the camera's frame with it; z up
  FragmentDetectorConfig detector;
};
/// @throws InvalidInput  lists all problems
FragmentDetectorParams loadFragmentDetectorParams(const ros::NodeHandle& nh);

/// Subscribes to `left/image_raw`, `left/camera_info`, `right/...`: four messages of one stamp are
/// a pair. Publishes `fragments` for each, `fragments/poses` and, if somebody listens,
/// `fragments/image`. A pair that cannot be used is not answered; the reason is in the log and in
/// /diagnostics.
class FragmentDetectorNode {
 public:
  FragmentDetectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                       const FragmentDetectorParams& params);

 private:
  using Sync = message_filters::TimeSynchronizer<sensor_msgs::Image, sensor_msgs::CameraInfo,
                                                 sensor_msgs::Image, sensor_msgs::CameraInfo>;
  void onPair(const sensor_msgs::ImageConstPtr& left,
              const sensor_msgs::CameraInfoConstPtr& left_info,
              const sensor_msgs::ImageConstPtr& right,
              const sensor_msgs::CameraInfoConstPtr& right_info);
  /// Prepared for this calibration and this place; the one before, if nothing has changed.
  const FragmentDetector& detectorFor(const sensor_msgs::CameraInfo& left,
                                      const sensor_msgs::CameraInfo& right);
  void publish(const std_msgs::Header& images, const std::vector<FragmentDetection>& fragments,
               const cv::Mat& rectified);
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

  FragmentDetectorParams params_;
  Registration field_;
  std::optional<FragmentDetector> detector_;
  sensor_msgs::CameraInfo left_info_, right_info_;  // that the detector was prepared for
  Pose X_field_camera_;                             // likewise
  std::uint64_t pairs_ = 0;
  std::uint64_t refused_ = 0;
  std::size_t found_ = 0;  // in the last pair
  double duration_ = 0.0;  // of the last detection [s]
  std::string problem_ = "no pair of images yet";

  ros::NodeHandle nh_;
  ros::Publisher fragments_, poses_, image_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  message_filters::Subscriber<sensor_msgs::Image> left_, right_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> left_calibration_, right_calibration_;
  Sync sync_;
};

}  // namespace raven_correction
