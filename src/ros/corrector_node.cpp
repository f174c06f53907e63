// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/corrector_node.h"

#include <pthread.h>

#include "raven_correction/error.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/realtime.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kClockTolerance = 0.01;  ///< a smaller step back is that of a clock being set [s]
constexpr double kMasterPeriod = 1.0;     ///< between questions to the master [s]
constexpr double kTopicsPeriod = 5.0;     ///< between looks at which topics are there [s]

bool isAsked(const ArmRequest& request) noexcept {
  return request.kind == ArmRequest::Kind::kPose || request.kind == ArmRequest::Kind::kRelative;
}

/// All of the arms, or none.
bool setModes(const std::vector<CorrectedArm*>& arms, CorrectorMode mode, bool override_preflight,
              std::string& message) {
  for (const CorrectedArm* const arm : arms) {
    message = arm->refusal(mode, override_preflight);
    if (message.empty()) continue;
    ROS_WARN("corrector: not switched on: %s", message.c_str());
    return false;
  }
  message = std::string("mode ") + correctorModeName(mode);
  bool in_force = true;
  for (CorrectedArm* const arm : arms) in_force &= arm->setMode(mode, override_preflight);
  if (in_force) return true;
  for (CorrectedArm* const arm : arms) arm->setMode(CorrectorMode::kOff, false);
  message =
      "the robot was homed, its state was silent, or the correction was switched off meanwhile: "
      "all "
      "is off";
  return false;
}

/// @param priority  real-time; 0: that of all others
void beginLiveThread(int priority) {
  pthread_setname_np(pthread_self(), "corrector_live");  // as top and chrt show it
  if (priority == 0) return;
  const std::string refusal = takeRealtimePriority(priority);
  if (refusal.empty())
    ROS_INFO("corrector: poses are handled with real-time priority %d", priority);
  else
    ROS_WARN("corrector: %s", refusal.c_str());
}

/// Bit for bit, in the parts that are asked for.
bool isChanged(const ArmRequest& request, const Pose& command) noexcept {
  return (request.position && command.p != request.pose.p) ||
         (request.orientation && command.q.coeffs() != request.pose.q.coeffs());
}

}  // namespace

CorrectorNode::CorrectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh),
      private_nh_(private_nh),
      params_(loadCorrectorParams(private_nh)),
      homing_watch_(std::max(HomingWatch::kSilence, params_.robot_state_timeout)) {
  std::vector<CorrectedArm*> all;
  for (const CorrectedArmParams& arm : params_.arms) {
    arm_names_.push_back(arm.name);
    arms_.push_back(std::make_unique<CorrectedArm>(nh_, private_nh_, params_, arm, live_queue_,
                                                   model_queue_, check_queue_));
    all.push_back(arms_.back().get());
  }
  robot_ready_ = params_.robot_state_topic.empty();
  updateHold();
  doFirst(live_queue_, [priority = params_.realtime_priority] { beginLiveThread(priority); });

  if (params_.pose_type == "PoseStamped")
    subscribeDesired<geometry_msgs::PoseStamped>();
  else if (params_.pose_type == "TransformStamped")
    subscribeDesired<geometry_msgs::TransformStamped>();
  else
    subscribeDesired<RavenCommand>();
  if (!params_.robot_state_topic.empty()) {
    ros::NodeHandle live(nh_);
    live.setCallbackQueue(&live_queue_);
    robot_state_subscriber_ = live.subscribe<AnyMessage>(
        params_.robot_state_topic, 1,
        boost::function<void(const ros::MessageEvent<AnyMessage const>&)>(
            [this](const ros::MessageEvent<AnyMessage const>& event) { onRobotState(event); }));
  }
  offerServices("", all);
  if (arms_.size() > 1)
    for (CorrectedArm* const arm : all) offerServices(arm->ns() + "/", {arm});
  for (CorrectedArm* const arm : all) offerPreflight(*arm);
  for (const ros::ServiceServer& service : services_)
    registrations_.addService(service.getService());
  registrations_.addService(private_nh_.resolveName("set_parameters"));  // of dynamic_reconfigure
  tuning_in_force_.gain = params_.gain;
  tuning_in_force_.max_translation = params_.limits.max_translation;
  tuning_in_force_.max_rotation = params_.limits.max_rotation;
  tuning_ = std::make_unique<dynamic_reconfigure::Server<CorrectorConfig>>(private_nh_);
  tuning_->setCallback(
      [this](CorrectorConfig& config, std::uint32_t /*level*/) { onTuning(config); });
  if (params_.watch_output) {
    watchOutput();  // before the first pose
    ros::NodeHandle slow(nh_);
    slow.setCallbackQueue(&master_queue_);
    master_timer_ = slow.createWallTimer(ros::WallDuration(kMasterPeriod),
                                         [this](const ros::WallTimerEvent&) { watchOutput(); });
  }
  ros::NodeHandle slow(nh_);
  slow.setCallbackQueue(&master_queue_);
  topics_timer_ = slow.createWallTimer(ros::WallDuration(kTopicsPeriod),
                                       [this](const ros::WallTimerEvent&) { lookAtTopics(); });
  live_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &live_queue_);
  live_spinner_->start();
  model_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &model_queue_);
  model_spinner_->start();
  master_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &master_queue_);
  master_spinner_->start();
  // One that may wait for each arm's pre-flight, and one for the rest.
  check_spinner_ = std::make_unique<ros::AsyncSpinner>(static_cast<std::uint32_t>(arms_.size() + 1),
                                                       &check_queue_);
  check_spinner_->start();
  switch_spinner_ = std::make_unique<ros::AsyncSpinner>(2, &switch_queue_);
  switch_spinner_->start();
  ROS_INFO("corrector: %s -> %s (%s)", desired_subscriber_.getTopic().c_str(),
           command_publisher_.getTopic().c_str(), params_.pose_type.c_str());
}

CorrectorNode::~CorrectorNode() {
  for (const auto& arm : arms_) arm->stop();
  check_spinner_->stop();
  switch_spinner_->stop();
  live_spinner_->stop();
  model_spinner_->stop();
  master_spinner_->stop();
}

template <typename Message>
void CorrectorNode::subscribeDesired() {
  command_publisher_ = nh_.advertise<Message>(topics::kCommand, 1);
  ros::NodeHandle live(nh_);
  live.setCallbackQueue(&live_queue_);
  desired_subscriber_ = live.subscribe<Message>(
      topics::kDesired, 1,
      boost::function<void(const ros::MessageEvent<Message const>&)>(
          [this](const ros::MessageEvent<Message const>& event) { onDesired<Message>(event); }),
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

// --- live ----------------------------------------------------------------------------------------

/// A bag that loops, a simulation that starts again.
void CorrectorNode::watchClock(const ros::Time& now) {
  if (now + ros::Duration(kClockTolerance) < last_now_) {
    ROS_WARN("corrector: the clock went back by %.3f s; starting over", (last_now_ - now).toSec());
    for (const auto& arm : arms_) arm->restart();
  }
  if (!now.isZero())
    for (const auto& arm : arms_) arm->boundHomings(now.toSec());
  last_now_ = now;
}

void CorrectorNode::watchRobotState(const ros::SteadyTime& now) {
  if (params_.robot_state_topic.empty()) return;
  const std::optional<RobotState>& state = homing_watch_.state();
  const bool ready =
      state && state->ready() && now.toSec() - homing_watch_.at() <= params_.robot_state_timeout;
  if (robot_ready_.exchange(ready) != ready) updateHold();
}

/// What becomes of a command. @return it is to be sent
bool CorrectorNode::decide(bool readable, bool latched, double now, CommandRequest& request,
                           Outputs& outputs) {
  const auto refuseAll = [&](CorrectorCode code) {
    for (CorrectorOutput& output : outputs) output.code = code;
    return false;
  };
  if (!readable) {
    // Which arms it was for is not known: all of them are told.
    request = {};
    for (ArmRequest& arm : request.arms) arm.kind = ArmRequest::Kind::kInactive;
    return refuseAll(CorrectorCode::kRefusedMalformed);
  }
  if (latched) return refuseAll(CorrectorCode::kRefusedLatched);
  bool asked = false;
  for (std::size_t i = 0; i < arms_.size(); ++i) asked |= isAsked(request.arms[i]);
  if (asked && !sameName(request.frame, params_.base_frame) &&
      !(request.frame.empty() && params_.allow_empty_frame))
    return refuseAll(CorrectorCode::kRefusedFrame);

  const double stamp = request.stamp.toSec();
  std::array<std::optional<CorrectorCode>, kMaxCorrectedArms> refused;
  const auto anyRefused = [&] {
    bool any = false;
    for (const auto& code : refused) any |= code.has_value();
    for (std::size_t i = 0; any && i < arms_.size(); ++i)
      outputs[i].code = refused[i].value_or(CorrectorCode::kRefusedWithOtherArm);
    return any;
  };
  // All are looked at before any counts: a refused command changes nothing.
  for (std::size_t i = 0; i < arms_.size(); ++i)
    if (isAsked(request.arms[i])) refused[i] = arms_[i]->fault(request.arms[i], stamp, now);
  if (anyRefused()) return false;
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    if (request.arms[i].kind == ArmRequest::Kind::kAbsent) continue;
    outputs[i] = arms_[i]->prepare(request.arms[i], stamp, now);
    if (isRefused(outputs[i].code)) refused[i] = outputs[i].code;
  }
  const bool sent = !anyRefused();
  for (std::size_t i = 0; i < arms_.size(); ++i)
    if (request.arms[i].kind != ArmRequest::Kind::kAbsent && (sent || refused[i]))
      arms_[i]->commit(sent);
  return sent;
}

template <typename Message>
void CorrectorNode::onDesired(const ros::MessageEvent<Message const>& event) {
  const ros::SteadyTime arrival = ros::SteadyTime::now();
  const boost::shared_ptr<Message const> message = event.getConstMessage();
  const ros::Time now = ros::Time::now();
  watchClock(now);
  watchRobotState(arrival);
  CommandRequest request;
  Outputs outputs;
  const bool readable = readCommand(*message, arm_names_, request);
  auto& pool = std::get<MessagePool<Message>>(pools_);
  if (readable) pool.makeRoomFor(*message);
  const bool latched = replays_.isReplay(event.getConnectionHeaderPtr());
  if (decide(readable, latched, now.toSec(), request, outputs)) {
    // Header and all else stay as the planner sent them; an unchanged command is the same message.
    boost::shared_ptr<Message> changed;
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      if (!isAsked(request.arms[i]) || !isChanged(request.arms[i], outputs[i].command)) continue;
      if (changed == nullptr) {
        changed = pool.next();
        *changed = *message;
      }
      writeCommand(*changed, request.arms[i], outputs[i].command);
    }
    if (changed != nullptr)
      command_publisher_.publish(changed);
    else
      command_publisher_.publish(message);
  }
  const double compute_time = (ros::SteadyTime::now() - arrival).toSec();
  for (std::size_t i = 0; i < arms_.size(); ++i)
    if (request.arms[i].kind != ArmRequest::Kind::kAbsent)
      arms_[i]->report(request, now.toSec(), request.arms[i], outputs[i], compute_time);
}

template void CorrectorNode::onDesired(
    const ros::MessageEvent<geometry_msgs::PoseStamped const>& event);
template void CorrectorNode::onDesired(
    const ros::MessageEvent<geometry_msgs::TransformStamped const>& event);
template void CorrectorNode::onDesired(const ros::MessageEvent<RavenCommand const>& event);

void CorrectorNode::onRobotState(const ros::MessageEvent<AnyMessage const>& event) {
  const auto md5sum = event.getConnectionHeader().find("md5sum");
  const auto state =
      readRobotState(md5sum == event.getConnectionHeader().end() ? std::string() : md5sum->second,
                     event.getConstMessage()->bytes);
  if (!state) {
    if (!robot_state_warned_)
      ROS_ERROR(
          "corrector: %s has a type that says nothing of a robot's state, expected "
          "crtk_msgs/operating_state, raven_2_msgs/RavenState or raven_2/raven_state; "
          "nothing is corrected",
          robot_state_subscriber_.getTopic().c_str());
    robot_state_warned_ = true;
    return;
  }
  watchClock(ros::Time::now());
  const ros::SteadyTime now = ros::SteadyTime::now();
  const HomingWatch::Homing homing = homing_watch_.update(*state, now.toSec());
  if (homing != HomingWatch::Homing::kNone)
    for (const auto& arm : arms_) arm->noteHoming(homing);
  watchRobotState(now);
}

// --- others --------------------------------------------------------------------------------------

CorrectionHold CorrectorNode::holdNow() const noexcept {
  if (!alone_) return CorrectionHold::kOtherPublisher;
  return robot_ready_ ? CorrectionHold::kNone : CorrectionHold::kRobotNotReady;
}

/// Of the live thread and of the one that asks the master, without a lock: whoever writes last has
/// seen what both of them know.
void CorrectorNode::updateHold() noexcept {
  CorrectionHold hold;
  do {
    hold = holdNow();
    for (const auto& arm : arms_) arm->setHold(hold);
  } while (hold != holdNow());
}

void CorrectorNode::noteMaster(const MasterView& view) {
  if (!view.answered) {
    if (!master_lost_) ROS_WARN("corrector: the master does not answer; correction goes on");
    master_lost_ = true;
    return;
  }
  for (const auto& arm : arms_) arm->noteMaster();
  if (!view.registered) forgotten_ = true;
  if (forgotten_ && registrations_.repeat()) {
    forgotten_ = false;
    ROS_WARN("corrector: the master was started anew and has been told of this node again");
  } else if (master_lost_) {
    ROS_INFO("corrector: the master answers again");
  }
  master_lost_ = false;
  other_publisher_ = view.other_publishers.empty() ? "" : view.other_publishers.front();
}

void CorrectorNode::watchOutput() {
  const std::string& topic = command_publisher_.getTopic();
  noteMaster(askMaster(topic));
  const bool here = publishersInThisProcess(topic) > 1;
  const bool alone = !here && other_publisher_.empty();
  if (alone_.exchange(alone) == alone) return;
  updateHold();
  if (alone)
    ROS_WARN("corrector: the only publisher on %s again", topic.c_str());
  else
    ROS_ERROR("corrector: %s publishes on %s, too: nothing is corrected until it stops",
              here ? "somebody in this process" : other_publisher_.c_str(), topic.c_str());
}

/// Topics that have to be there and are not, with what is there instead.
void CorrectorNode::lookAtTopics() {
  std::vector<TopicType> published;
  if (!askTopics(published)) return;
  const char* const type = params_.pose_type == "RavenCommand" ? "raven_2_msgs/" : "geometry_msgs/";
  std::vector<TopicType> common{{desired_subscriber_.getTopic(), type + params_.pose_type}};
  if (robot_state_subscriber_) common.push_back({robot_state_subscriber_.getTopic(), ""});
  for (const auto& arm : arms_) {
    std::vector<TopicType> expected = common;
    for (const TopicType& topic : arm->expectedTopics()) expected.push_back(topic);
    arm->noteTopics(checkTopics(expected, published));
  }
}

/// What cannot be taken is answered with what is in force: the server would keep it, and refuse
/// every later change with it.
void CorrectorNode::onTuning(CorrectorConfig& config) {
  try {
    for (const auto& arm : arms_)
      arm->setTuning(config.gain, config.max_translation, config.max_rotation);
    ROS_INFO("corrector: gain %g, at most %g m and %g rad", config.gain, config.max_translation,
             config.max_rotation);
    tuning_in_force_ = config;
  } catch (const InvalidInput& error) {
    ROS_ERROR("%s; nothing was changed", error.what());
    config = tuning_in_force_;
  }
}

void CorrectorNode::offerServices(const std::string& ns, const std::vector<CorrectedArm*>& arms) {
  using SetModeCallback = boost::function<bool(SetMode::Request&, SetMode::Response&)>;
  using EnableCallback =
      boost::function<bool(std_srvs::SetBool::Request&, std_srvs::SetBool::Response&)>;
  const SetModeCallback set_mode = [arms](SetMode::Request& request, SetMode::Response& response) {
    response.previous = correctorModeName(arms.front()->mode());
    try {
      const CorrectorMode mode = correctorModeFromName(request.mode);
      response.success = setModes(arms, mode, request.override_preflight, response.message);
    } catch (const InvalidInput& error) {
      response.message = error.what();
    }
    return true;
  };
  const CorrectorMode on = correctorModeFromName(params_.mode);
  const EnableCallback enable = [arms, on](std_srvs::SetBool::Request& request,
                                           std_srvs::SetBool::Response& response) {
    response.success =
        setModes(arms, request.data ? on : CorrectorMode::kOff, false, response.message);
    for (CorrectedArm* const arm : arms) {
      if (response.success && request.data && !arm->hasModel())
        response.message += "; no model yet" + (arm->ns().empty() ? "" : " for " + arm->ns()) +
                            ": poses pass unchanged until the trainer publishes one";
    }
    return true;
  };
  ros::NodeHandle switches(private_nh_);
  switches.setCallbackQueue(&switch_queue_);
  services_.push_back(switches.advertiseService(ns + "set_mode", set_mode));
  services_.push_back(switches.advertiseService(ns + "enable", enable));
}

/// Answered by a thread that may wait: what switches the correction off never does.
void CorrectorNode::offerPreflight(CorrectedArm& arm) {
  ros::NodeHandle slow(private_nh_);
  slow.setCallbackQueue(&check_queue_);
  services_.push_back(slow.advertiseService<Preflight::Request, Preflight::Response>(
      arm.ns().empty() || arms_.size() == 1 ? "preflight" : arm.ns() + "/preflight",
      boost::function<bool(Preflight::Request&, Preflight::Response&)>(
          [&arm](Preflight::Request& request, Preflight::Response& response) {
            arm.preflight(request, response);
            return true;
          })));
}

}  // namespace raven_correction
