// SPDX-License-Identifier: BSD-3-Clause
// The node `field_camera`: stands where the driver of a calibrated stereo camera over the field of
// debridement stands, and says what is really there. Who looks for fragments in its images is
// fragment_detector_node.h.
#pragma once

#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/JawEvent.h"
#include "raven_correction/LoadScene.h"
#include "raven_correction/ros/jaw_event.h"
#include "raven_correction/simulation/debridement_field.h"
#include "raven_correction/simulation/stereo_renderer.h"

namespace raven_correction {

struct FieldCameraParams {
  int seed = 1;       ///< of the first scene, in [0, 2^31)
  double rate = 5.0;  ///< of pairs of images [Hz], in [0, 30]; 0: when ~take_picture is called
  std::string base_frame = "0_link";          ///< the field is published in it, on /tf_static
  std::string field_frame = "field";          ///< origin in the middle of the platform, z up
  std::string camera_frame = "field_camera";  ///< rectified left camera; of the images
  Eigen::Vector3d p_base_field{-0.020, -0.058, -0.170};  ///< [m]
  DebridementSceneConfig scene;
  StereoRigConfig rig;
  DebridementFieldConfig field;       ///< what grippers do to it
  std::vector<std::string> grippers;  ///< namespaces of the simulated arms that work on it
};
/// @throws InvalidInput  lists all problems
FieldCameraParams loadFieldCameraParams(const ros::NodeHandle& nh);

/// Publishes `left/image_raw`, `left/camera_info`, `right/...` with one stamp per pair, and
/// `~truth` (latched). `~next_scene` draws the scene of the next seed, `~load_scene` that of any.
/// Where `grippers` are named, it decides what their jaws hold: fragments leave the field and come
/// back to it (`~grasps`). Instruments do not show in the images.
class FieldCameraNode {
 public:
  /// @throws InvalidInput  a rig or a scene out of range
  FieldCameraNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                  const FieldCameraParams& params);

 private:
  bool onNextScene(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool onLoadScene(LoadScene::Request& request, LoadScene::Response& response);
  bool onTakePicture(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  void onJaw(const std::string& gripper, const JawEvent& event);
  void setScene(std::uint64_t seed);
  void expose();
  void publishFrame();

  FieldCameraParams params_;
  StereoRig rig_;
  StereoRenderer renderer_;
  DebridementField field_;
  StereoExposure exposure_;
  std::uint64_t scene_seed_;
  std::uint64_t frame_ = 0;

  ros::NodeHandle nh_;
  ros::Publisher left_image_, left_info_, right_image_, right_info_, truth_, grasps_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
  std::vector<ros::Subscriber> jaws_;
  ros::ServiceServer next_scene_, load_scene_, take_picture_;
  ros::Timer timer_;
};

}  // namespace raven_correction
