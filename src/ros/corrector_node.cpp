// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/corrector_node.h"

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

Pose poseOf(const geometry_msgs::PoseStamped& msg) { return poseFromMsg(msg.pose); }
Pose poseOf(const geometry_msgs::TransformStamped& msg) { return poseFromMsg(msg.transform); }

/// The same message with another pose: header and child frame stay as the planner sent them.
geometry_msgs::PoseStamped withPose(geometry_msgs::PoseStamped msg, const Pose& pose) {
  msg.pose = poseToMsg(pose);
  return msg;
}
geometry_msgs::TransformStamped withPose(geometry_msgs::TransformStamped msg, const Pose& pose) {
  msg.transform = transformToMsg(pose);
  return msg;
}

constexpr double kClockTolerance = 0.01;  // [s]

}  // namespace

CorrectorParams loadCorrectorParams(const ros::NodeHandle& nh) {
  CorrectorParams params;
  CorrectorLimits& limits = params.limits;
  ParamReader read(nh, "corrector");
  read.text("base_frame", params.base_frame);
  read.oneOf("pose_type", params.pose_type, {"PoseStamped", "TransformStamped"});
  read.oneOf("mode", params.mode, {"rigid", "full", "endpoint"});
  read.flag("enabled", params.enabled);
  read.text("model", params.model);
  read.positive("max_translation", limits.max_translation, 0.2);
  read.positive("max_rotation", limits.max_rotation, 3.1416);
  read.positive("max_translation_rate", limits.max_translation_rate, 10.0);
  read.positive("max_rotation_rate", limits.max_rotation_rate, 100.0);
  read.positive("max_step_time", limits.max_step_time, 1.0);
  read.number("max_age", limits.max_age, 0.0, 60.0);
  read.number("max_ahead", limits.max_ahead, 0.0, 60.0);
  std::vector<double> box_min(3, 0.0), box_max(3, 0.0);
  read.numbers("box_min", box_min, 3, -10.0, 10.0);
  read.numbers("box_max", box_max, 3, -10.0, 10.0);
  limits.box_min = {box_min[0], box_min[1], box_min[2]};
  limits.box_max = {box_max[0], box_max[1], box_max[2]};
  read.refuseUnknownKeys({"diagnostic_period"});
  read.throwIfAnyProblem();
  params.base_frame = withoutSlash(params.base_frame);
  ROS_INFO("%s", read.summary().c_str());
  return params;
}

CorrectorNode::CorrectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh),
      private_nh_(private_nh),
      params_(loadCorrectorParams(private_nh)),
      corrector_(params_.limits),
      diagnostics_(nh, private_nh),
      live_nh_(nh) {
  live_nh_.setCallbackQueue(&live_queue_);
  status_publisher_ = nh_.advertise<CorrectionStatus>(topics::kStatus, 100);
  if (!params_.model.empty()) useModel(readModelFile(params_.model));
  setMode(params_.enabled ? correctorModeFromName(params_.mode) : CorrectorMode::kOff);
  diagnostics_.setHardwareID("none");
  diagnostics_.add("correction", this, &CorrectorNode::diagnose);

  if (params_.pose_type == "PoseStamped")
    subscribeDesired<geometry_msgs::PoseStamped>();
  else
    subscribeDesired<geometry_msgs::TransformStamped>();
  path_subscriber_ = live_nh_.subscribe(topics::kDesiredPath, 1, &CorrectorNode::onPath, this);
  model_subscriber_ = nh_.subscribe(topics::kModel, 1, &CorrectorNode::onModel, this);
  mode_service_ = private_nh_.advertiseService("set_mode", &CorrectorNode::onSetMode, this);
  enable_service_ = private_nh_.advertiseService("enable", &CorrectorNode::onEnable, this);
  diagnostics_timer_ = nh_.createTimer(ros::Duration(1.0),
                                       [this](const ros::TimerEvent&) { diagnostics_.update(); });
  live_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &live_queue_);
  live_spinner_->start();
  ROS_INFO("corrector: %s -> %s, model from %s", desired_subscriber_.getTopic().c_str(),
           command_publisher_.getTopic().c_str(), model_subscriber_.getTopic().c_str());
}

CorrectorNode::~CorrectorNode() { live_spinner_->stop(); }

template <typename Message>
void CorrectorNode::subscribeDesired() {
  command_publisher_ = nh_.advertise<Message>(topics::kCommand, 1);
  desired_subscriber_ = live_nh_.subscribe<Message>(
      topics::kDesired, 1,
      boost::function<void(const ros::MessageEvent<Message const>&)>(
          [this](const ros::MessageEvent<Message const>& event) { onDesired<Message>(event); }),
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

/// The first message of a latched publisher may be from yesterday.
bool CorrectorNode::isStaleLatched(const ros::M_string& header) {
  const auto latching = header.find("latching");
  if (latching == header.end() || latching->second != "1") return false;
  const auto caller = header.find("callerid");
  return latched_publishers_.insert(caller == header.end() ? "" : caller->second).second;
}

bool CorrectorNode::isEndpoint(const Pose& desired) const {
  if (!has_path_) return false;
  const auto same = [&](const Pose& end) {
    return (desired.p - end.p).norm() < 1e-6 && rotationAngle(desired.q, end.q) < 1e-6;
  };
  return same(path_first_) || same(path_last_);
}

template <typename Message>
void CorrectorNode::onDesired(const ros::MessageEvent<Message const>& event) {
  const ros::SteadyTime arrival = ros::SteadyTime::now();
  const Message& msg = *event.getConstMessage();
  const Pose desired = poseOf(msg);
  const ros::Time now = ros::Time::now();
  // A bag that loops, a simulation that starts again; not the small steps of a clock that is set.
  if (now + ros::Duration(kClockTolerance) < last_now_) {
    ROS_WARN("corrector: the clock went back by %.3f s; starting over", (last_now_ - now).toSec());
    corrector_.restart();
  }
  last_now_ = now;

  CorrectorOutput output;
  output.command = desired;
  if (isStaleLatched(event.getConnectionHeader()))
    output.code = CorrectorCode::kRefusedLatched;
  else if (withoutSlash(msg.header.frame_id) != params_.base_frame)
    output.code = CorrectorCode::kRefusedFrame;
  else
    output =
        corrector_.correct(msg.header.stamp.toSec(), now.toSec(), desired, isEndpoint(desired));
  const bool refused = isRefused(output.code);
  if (!refused) command_publisher_.publish(withPose(msg, output.command));

  const double compute_time = (ros::SteadyTime::now() - arrival).toSec();
  ++counts_[static_cast<std::size_t>(output.code)];
  if (compute_time > worst_compute_time_) worst_compute_time_ = compute_time;
  CorrectionStatus status;
  status.header.stamp = msg.header.stamp;
  status.header.frame_id = params_.base_frame;
  status.code = static_cast<std::uint8_t>(output.code);
  status.mode = correctorModeName(corrector_.mode());
  if (output.model != nullptr) status.model = *output.model;
  status.desired = poseToMsg(desired);
  if (!refused) status.command = poseToMsg(output.command);
  status.sd_position = vectorToMsg(output.sd_position);
  status.sd_rotation = vectorToMsg(output.sd_rotation);
  status.h_share = output.h_share;
  status.compute_time = compute_time;
  status_publisher_.publish(status);
}

void CorrectorNode::onPath(const geometry_msgs::PoseArray& path) {
  has_path_ = !path.poses.empty() && withoutSlash(path.header.frame_id) == params_.base_frame;
  if (!has_path_) return;
  path_first_ = poseFromMsg(path.poses.front());
  path_last_ = poseFromMsg(path.poses.back());
}

void CorrectorNode::useModel(const Correction& model) {
  if (withoutSlash(model.frame) != params_.base_frame)
    throw InvalidInput(format("model %s is for the frame \"%s\", this corrector works in \"%s\"",
                              model.id.c_str(), model.frame.c_str(), params_.base_frame.c_str()));
  corrector_.setModel(model);
  const std::lock_guard<std::mutex> lock(mutex_);
  model_id_ = model.id;
}

void CorrectorNode::onModel(const CorrectionModel& msg) {
  try {
    useModel(modelFromMsg(msg));
    ROS_INFO("corrector: model %s is in use", msg.id.c_str());
  } catch (const std::exception& error) {
    ROS_ERROR("corrector: model refused, the one before stays in use: %s", error.what());
  }
}

void CorrectorNode::setMode(CorrectorMode mode) {
  corrector_.setMode(mode);
  ROS_INFO("corrector: mode %s", correctorModeName(mode));
}

bool CorrectorNode::onSetMode(SetMode::Request& request, SetMode::Response& response) {
  response.previous = correctorModeName(corrector_.mode());
  try {
    setMode(correctorModeFromName(request.mode));
    response.success = true;
    response.message = "mode " + request.mode;
  } catch (const InvalidInput& error) {
    response.message = error.what();
  }
  return true;
}

bool CorrectorNode::onEnable(std_srvs::SetBool::Request& request,
                             std_srvs::SetBool::Response& response) {
  setMode(request.data ? correctorModeFromName(params_.mode) : CorrectorMode::kOff);
  const std::lock_guard<std::mutex> lock(mutex_);
  response.success = true;
  response.message = std::string("mode ") + correctorModeName(corrector_.mode());
  if (request.data && model_id_.empty())
    response.message += "; no model yet: poses pass unchanged until the trainer publishes one";
  return true;
}

void CorrectorNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  std::uint64_t all = 0, refused = 0, passed = 0, limited = 0, fault = 0;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const std::uint64_t total = counts_[i];
    const std::uint64_t recent = total - reported_[i];
    reported_[i] = total;
    all += recent;
    const auto code = static_cast<CorrectorCode>(i);
    if (isRefused(code)) refused += recent;
    if (code == CorrectorCode::kCorrectedLimited) limited += recent;
    if (code == CorrectorCode::kPassedModelFault) fault += recent;
    if (code >= CorrectorCode::kPassedOff && code <= CorrectorCode::kPassedBetweenEndpoints)
      passed += recent;
    if (total > 0) status.add(correctorCodeName(code), std::to_string(total));
  }
  status.add("model", model_id_.empty() ? "none" : model_id_);
  status.add("mode", correctorModeName(corrector_.mode()));
  status.add("longest compute time [us]", format("%.0f", 1e6 * worst_compute_time_.exchange(0.0)));
  if (fault > 0)
    status.summaryf(Level::ERROR, "the model answered %lu poses with numbers that are not finite",
                    fault);
  else if (all == 0)
    status.summary(Level::OK, "the planner is silent");
  else if (refused > 0)
    status.summaryf(Level::WARN, "%lu of %lu poses refused", refused, all);
  else
    status.summaryf(Level::OK, "%lu poses: %lu passed unchanged, %lu limited", all, passed,
                    limited);
}

}  // namespace raven_correction
