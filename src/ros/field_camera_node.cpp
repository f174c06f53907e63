// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/field_camera_node.h"

#include <geometry_msgs/TransformStamped.h>

#include <algorithm>

#include "raven_correction/FragmentArray.h"
#include "raven_correction/GraspResult.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/image_conversions.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

geometry_msgs::TransformStamped transformOf(const std::string& parent, const std::string& child,
                                            const Pose& X_parent_child, const ros::Time& stamp) {
  geometry_msgs::TransformStamped msg;
  msg.header.stamp = stamp;
  msg.header.frame_id = parent;
  msg.child_frame_id = child;
  msg.transform = transformToMsg(X_parent_child);
  return msg;
}

}  // namespace

FieldCameraParams loadFieldCameraParams(const ros::NodeHandle& nh) {
  FieldCameraParams params;
  std::vector<double> field(params.p_base_field.data(), params.p_base_field.data() + 3);
  ParamReader read(nh, "field_camera");
  read.integer("seed", params.seed, 0, 2147483647);
  read.number("rate", params.rate, 0.0, 30.0);
  read.text("base_frame", params.base_frame);
  read.text("field_frame", params.field_frame);
  read.text("camera_frame", params.camera_frame);
  read.numbers("field_position", field, 3, -2.0, 2.0);
  read.integer("fragments_min", params.scene.fragments_min, 0, 30);
  read.integer("fragments_max", params.scene.fragments_max, 0, 30);
  read.number("field_size", params.scene.field_size, 0.02, 0.1);
  read.number("neighbour_share", params.scene.neighbour_share, 0.0, 1.0);
  read.integer("width", params.rig.width, 160, 1920);
  read.integer("height", params.rig.height, 120, 1200);
  read.number("focal", params.rig.focal, 100.0, 10000.0);
  read.number("baseline", params.rig.baseline, 0.005, 0.3);
  read.number("distance", params.rig.distance, 0.1, 1.5);
  read.number("tilt", params.rig.tilt, -1.0, 1.0);
  read.number("azimuth", params.rig.azimuth, -3.2, 3.2);
  read.texts("grippers", params.grippers);
  std::vector<double> receptacles;
  read.numbers("receptacles", receptacles, 3 * params.grippers.size(), -2.0, 2.0);
  read.positive("receptacle_radius", params.field.receptacle_radius, 0.2);
  GraspConfig& grasp = params.field.grasp;
  read.positive("finger", grasp.finger, 0.1);
  read.number("squeeze", grasp.squeeze, 0.0, 0.05);
  read.positive("grasp_height", grasp.height, 0.05);
  read.positive("grasp_along_pads", grasp.along_pads, 0.05);
  read.positive("grasp_tilt", grasp.tilt, 1.5);
  if (params.scene.fragments_max < params.scene.fragments_min)
    read.problem("fragments_max", format("%d is less than fragments_min = %d",
                                         params.scene.fragments_max, params.scene.fragments_min));
  read.refuseUnknownKeys();
  read.throwIfAnyProblem();
  if (field.size() == 3) params.p_base_field = Eigen::Vector3d(field[0], field[1], field[2]);
  for (std::size_t i = 0; i + 2 < receptacles.size(); i += 3)
    params.field.p_field_receptacle.push_back(
        Eigen::Vector3d(receptacles[i], receptacles[i + 1], receptacles[i + 2]) -
        params.p_base_field);
  params.field.field_size = params.scene.field_size;
  params.base_frame = withoutSlash(params.base_frame);
  params.field_frame = withoutSlash(params.field_frame);
  params.camera_frame = withoutSlash(params.camera_frame);
  ROS_INFO_STREAM(read.summary());
  return params;
}

FieldCameraNode::FieldCameraNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                                 const FieldCameraParams& params)
    : params_(params),
      rig_(makeStereoRig(params.rig)),
      renderer_(rig_.camera),
      field_(params.field),
      scene_seed_(static_cast<std::uint64_t>(params.seed)),
      nh_(nh) {
  ros::NodeHandle own(private_nh);
  left_image_ = nh_.advertise<sensor_msgs::Image>(topics::kLeftImage, 2);
  left_info_ = nh_.advertise<sensor_msgs::CameraInfo>(topics::kLeftInfo, 2);
  right_image_ = nh_.advertise<sensor_msgs::Image>(topics::kRightImage, 2);
  right_info_ = nh_.advertise<sensor_msgs::CameraInfo>(topics::kRightInfo, 2);
  truth_ = own.advertise<FragmentArray>("truth", 1, true);
  grasps_ = own.advertise<GraspResult>("grasps", 20);
  const ros::Time now = ros::Time::now();
  static_broadcaster_.sendTransform(
      {transformOf(params.base_frame, params.field_frame,
                   {params.p_base_field, Eigen::Quaterniond::Identity()}, now),
       transformOf(params.field_frame, params.camera_frame, rig_.X_field_camera, now)});
  setScene(scene_seed_);
  next_scene_ = own.advertiseService("next_scene", &FieldCameraNode::onNextScene, this);
  load_scene_ = own.advertiseService("load_scene", &FieldCameraNode::onLoadScene, this);
  take_picture_ = own.advertiseService("take_picture", &FieldCameraNode::onTakePicture, this);
  for (const std::string& gripper : params.grippers)
    jaws_.push_back(nh_.subscribe<JawEvent>(
        gripper + "/" + kJawEventTopic, 10,
        [this, gripper](const JawEventConstPtr& event) { onJaw(gripper, *event); }));
  if (params.rate > 0.0)
    timer_ = nh_.createTimer(ros::Duration(1.0 / params.rate),
                             [this](const ros::TimerEvent&) { publishFrame(); });
  ROS_INFO("field_camera: publishes %s and %s, %d x %d px", left_image_.getTopic().c_str(),
           right_image_.getTopic().c_str(), params.rig.width, params.rig.height);
}

bool FieldCameraNode::onNextScene(std_srvs::Trigger::Request&,
                                  std_srvs::Trigger::Response& response) {
  setScene(scene_seed_ + 1);
  response.success = true;
  response.message =
      format("scene of seed %llu: %zu fragments", static_cast<unsigned long long>(scene_seed_),
             exposure_.fragments.size());
  return true;
}

bool FieldCameraNode::onLoadScene(LoadScene::Request& request, LoadScene::Response& response) {
  setScene(request.seed);
  response.success = true;
  response.fragments = static_cast<std::uint32_t>(exposure_.fragments.size());
  response.message = format("scene of seed %llu", static_cast<unsigned long long>(scene_seed_));
  return true;
}

bool FieldCameraNode::onTakePicture(std_srvs::Trigger::Request&,
                                    std_srvs::Trigger::Response& response) {
  publishFrame();
  response.success = true;
  response.message = "a pair of images was published";
  return true;
}

void FieldCameraNode::onJaw(const std::string& gripper, const JawEvent& event) {
  Pose X_field_tool = poseFromMsg(event.pose);
  X_field_tool.p -= params_.p_base_field;
  const JawOutcome outcome = event.event == JawEvent::CLOSED
                                 ? field_.close(gripper, X_field_tool, event.opening)
                                 : field_.open(gripper, X_field_tool);
  GraspResult msg;
  msg.header.stamp = event.header.stamp;
  msg.header.frame_id = params_.field_frame;
  msg.gripper = gripper;
  msg.outcome = static_cast<std::uint8_t>(outcome.kind);
  msg.fragment = outcome.fragment;
  msg.offset = vectorToMsg(outcome.fit.p_tool_fragment);
  msg.extent = outcome.fit.extent;
  msg.tilt = outcome.fit.tilt;
  msg.left = static_cast<std::uint32_t>(field_.scene().fragments.size());
  grasps_.publish(msg);
  if (outcome.kind == JawOutcome::Kind::kHeld || outcome.kind == JawOutcome::Kind::kDropped)
    expose();
}

void FieldCameraNode::setScene(std::uint64_t seed) {
  scene_seed_ = seed;
  field_.set(makeDebridementScene(params_.scene, seed));
  expose();
}

void FieldCameraNode::expose() {
  exposure_ = renderer_.expose(field_.scene(), rig_.X_field_camera);
  FragmentArray truth;
  truth.header.stamp = ros::Time::now();
  truth.header.frame_id = params_.field_frame;
  for (const VisibleFragment& fragment : exposure_.fragments) {
    Fragment msg;
    msg.position = pointToMsg(fragment.truth.p_field);
    msg.yaw = fragment.truth.yaw;
    msg.length = fragment.truth.length;
    msg.width = fragment.truth.width;
    msg.partly_hidden = std::min(fragment.visible_left, fragment.visible_right) < 0.95;
    truth.fragments.push_back(msg);
  }
  truth_.publish(truth);
}

void FieldCameraNode::publishFrame() {
  const StereoPicture picture = develop(exposure_, ++frame_);
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = params_.camera_frame;
  left_image_.publish(imageToMsg(picture.left, header));
  left_info_.publish(cameraToMsg(rig_.camera.left, header));
  right_image_.publish(imageToMsg(picture.right, header));
  right_info_.publish(cameraToMsg(rig_.camera.right, header));
}

}  // namespace raven_correction
