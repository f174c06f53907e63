// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/recorder.h"

#include <std_msgs/String.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <ctime>
#include <filesystem>

#include "raven_correction/Pair.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/pose_subscription.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kMegabyte = 1e6;         // [byte]
constexpr double kTimerPeriod = 0.1;      // [s]
constexpr double kWarningPeriod = 10.0;   // [s]
constexpr double kClockTolerance = 0.01;  // a smaller step back is jitter [s]

/// Space left where a directory is, or where it would be created [byte].
std::uint64_t freeBytesNear(const std::string& directory) {
  fs::path path = directory;
  while (!fs::exists(path) && path.has_relative_path()) path = path.parent_path();
  std::error_code error;
  const fs::space_info space = fs::space(path, error);
  return error ? 0 : space.available;
}

}  // namespace

Recorder::Recorder(ros::NodeHandle nh, ros::NodeHandle private_nh, const RecorderParams& params)
    : nh_(std::move(nh)),
      params_(params),
      registration_(params.base_frame),
      synchroniser_(params.pairs),
      delay_(params.delay),
      homing_watch_(std::max(HomingWatch::kSilence, params.robot_state_timeout)),
      free_bytes_(freeBytesNear(params.directory)),
      diagnostics_(nh_, private_nh) {
  last_diagnosis_ = ros::SteadyTime::now();
  pairs_publisher_ = nh_.advertise<Pair>(topics::kPairs, 1000);
  status_publisher_ = private_nh.advertise<RecorderStatus>("status", 10, /*latch=*/true);
  diagnostics_.setHardwareID("none");
  diagnostics_.add("recording", this, &Recorder::diagnose);

  const auto queue = static_cast<std::uint32_t>(params.subscriber_queue);
  const auto pose = [&](Stream stream, const char* topic, const std::string& type, auto callback) {
    streams_[stream].topic = topic;
    streams_[stream].subscriber = subscribePose(
        nh_, topic, type, queue,
        [this, callback](const auto& message) { (this->*callback)(message); }, params_.command_arm);
  };
  static_transforms_subscriber_ =
      nh_.subscribe(topics::kTfStatic, 100, &Recorder::onStaticTransforms, this);
  if (params.delay.max_change > 0.0)
    model_subscriber_ = nh_.subscribe<CorrectionModel>(
        topics::kModel, 1,
        [this](const auto& model) { delay_.setModel(model->id, model->speed_delay); });
  pose(kCommand, topics::kCommand, params.command_type, &Recorder::onCommand);
  pose(kDesired, topics::kDesired, params.command_type, &Recorder::onDesired);
  pose(kMocap, topics::kMocap, params.mocap_pose_type, &Recorder::onMocap);
  // An arm whose state comes in one message has no topics for its parts, or other ones.
  const bool measured_from_state = !params.robot_state_arm.empty();
  if (!measured_from_state)
    pose(kEncoder, topics::kEncoder, params.pose_type, &Recorder::onEncoder);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  const auto joints = [&](Stream stream, const char* topic) {
    streams_[stream].topic = topic;
    streams_[stream].subscriber = nh_.subscribe<sensor_msgs::JointState>(
        topic, queue,
        [this, stream](const sensor_msgs::JointStateConstPtr& message) {
          onJoints(stream, message);
        },
        ros::VoidConstPtr(), hints);
  };
  if (!measured_from_state) joints(kJoints, topics::kJoints);
  joints(kJawCommand, topics::kJawCommand);
  joints(kJaw, topics::kJaw);
  streams_[kEvents].topic = topics::kTrajectoryEvent;
  streams_[kEvents].subscriber =
      nh_.subscribe(topics::kTrajectoryEvent, queue, &Recorder::onEvent, this, hints);
  if (!params.robot_state_topic.empty())
    robot_state_subscriber_ = nh_.subscribe<AnyMessage>(
        params.robot_state_topic, queue,
        boost::function<void(const ros::MessageEvent<AnyMessage const>&)>(
            [this](const ros::MessageEvent<AnyMessage const>& event) { onRobotState(event); }),
        ros::VoidConstPtr(), hints);
  if (measured_from_state)
    for (const auto& [stream, topic] :
         {std::pair{kEncoder, topics::kEncoder}, std::pair{kJoints, topics::kJoints}}) {
      streams_[stream].topic = topic;
      streams_[stream].subscriber = robot_state_subscriber_;
    }
  startChecks();
  std::string names = "recorder: listens to";
  for (const StreamState& stream : streams_) names += " " + stream.subscriber.getTopic();
  ROS_INFO_STREAM(names << ", publishes " << pairs_publisher_.getTopic());

  if (params.auto_start) start("");
  start_service_ = private_nh.advertiseService("start", &Recorder::onStart, this);
  stop_service_ = private_nh.advertiseService("stop", &Recorder::onStop, this);
  timer_ = nh_.createWallTimer(ros::WallDuration(kTimerPeriod),
                               [this](const ros::WallTimerEvent&) { onTimer(); });
  publishStatus();
}

Recorder::~Recorder() {
  if (!running()) return;
  const SessionWriter::Progress end = writer_->close();
  ROS_INFO("recorder: %s: %s", end.bag.c_str(), end.message.c_str());
}

// --- streams -------------------------------------------------------------------------------------

ros::Time Recorder::note(Stream stream) {
  const ros::Time now = ros::Time::now();
  watchClock(now);
  streams_[stream].last = ros::SteadyTime::now();
  ++streams_[stream].heard;
  return now;
}

template <typename Message>
void Recorder::record(Stream stream, const ros::Time& time,
                      const boost::shared_ptr<const Message>& message) {
  if (!recording_) return;
  StreamState& state = streams_[stream];
  ++state.received;
  // Events name instants, and may be told in any order.
  const ros::Time& stamp = message->header.stamp;
  const double back = stream == kEvents ? 0.0 : state.order.add(stamp);
  if (back > 0.0) return leaveOut(state.topic, stamp, back);
  writer_->push(makeBagRecord(state.topic, time, message));
}

void Recorder::leaveOut(const std::string& topic, const ros::Time& stamp, double back) {
  ++out_of_order_;
  if (!order_message_.empty()) return;
  order_message_ = format(
      "%s: the stamp %.6f lies %.6f s before that of the message before it; such messages are left "
      "out of the bag: a clock was set back, a bag is played in a loop, or two nodes publish "
      "there; "
      "~stop and ~start begin a bag that takes them",
      topic.c_str(), stamp.toSec(), back);
  ROS_WARN("recorder: %s", order_message_.c_str());
}

geometry_msgs::PoseStampedConstPtr Recorder::withBaseFrame(
    const geometry_msgs::PoseStampedConstPtr& message) {
  if (!message->header.frame_id.empty()) return message;
  auto named = boost::make_shared<geometry_msgs::PoseStamped>(*message);
  named->header.frame_id = params_.base_frame;
  return named;
}

void Recorder::onCommand(const geometry_msgs::PoseStampedConstPtr& message) {
  const ros::Time now = note(kCommand);
  const auto command = withBaseFrame(message);
  record(kCommand, now, command);
  StampedPose sample = stampedPoseFromMsg(*command);
  const auto X_base_frame = check(StreamRole::kCommands, now, *command);
  if (!X_base_frame) return warnUnregistered(topics::kCommand, command->header.frame_id);
  sample.pose = *X_base_frame * sample.pose;
  delay_.addCommand(sample);
  publishPairs(synchroniser_.addCommand(sample));
}

void Recorder::onDesired(const geometry_msgs::PoseStampedConstPtr& message) {
  record(kDesired, note(kDesired), withBaseFrame(message));
}

void Recorder::onEncoder(const geometry_msgs::PoseStampedConstPtr& message) {
  const ros::Time now = note(kEncoder);
  const auto measured = withBaseFrame(message);
  const auto X_base_frame = check(StreamRole::kEncoders, now, *measured);
  if (X_base_frame) recordRegistration(measured->header.frame_id, *X_base_frame, now);
  record(kEncoder, now, measured);
}

void Recorder::onJoints(Stream stream, const sensor_msgs::JointStateConstPtr& message) {
  const ros::Time now = note(stream);
  record(stream, now, message);
  if (stream == kJoints)
    watch_->addJoints(message->header.stamp.toSec(), now.toSec(), message->name, message->position);
}

void Recorder::onMocap(const geometry_msgs::PoseStampedConstPtr& message) {
  const ros::Time now = note(kMocap);
  geometry_msgs::PoseStampedConstPtr seen = message;
  const bool name_frame = message->header.frame_id.empty() && !params_.mocap_frame.empty();
  if (name_frame || params_.mocap_stamp == "receipt") {
    auto completed = boost::make_shared<geometry_msgs::PoseStamped>(*message);
    if (name_frame) completed->header.frame_id = params_.mocap_frame;
    if (params_.mocap_stamp == "receipt") completed->header.stamp = now;
    seen = completed;
  }
  const auto X_base_mocap = check(StreamRole::kObservations, now, *seen);
  if (X_base_mocap) recordRegistration(seen->header.frame_id, *X_base_mocap, now);
  record(kMocap, now, seen);
  if (!X_base_mocap) return warnUnregistered(topics::kMocap, seen->header.frame_id);
  unregistered_message_.clear();
  StampedPose sample = stampedPoseFromMsg(*seen);
  sample.pose = *X_base_mocap * sample.pose;
  delay_.addObservation(sample);
  publishPairs(synchroniser_.addObservation(sample));
}

void Recorder::onEvent(const TrajectoryEventConstPtr& message) {
  record(kEvents, note(kEvents), message);
  const double stamp = message->header.stamp.toSec();
  if (message->event == TrajectoryEvent::START)
    trajectories_.start(message->trajectory, stamp);
  else if (trajectories_.end(message->trajectory, stamp) && recording_)
    ++completed_trajectories_;
}

void Recorder::onStaticTransforms(const tf2_msgs::TFMessageConstPtr& message) {
  static_transforms_.add(*message);
  recordStaticTransforms(ros::Time::now());
}

void Recorder::publishPairs(const std::vector<LivePair>& pairs) {
  for (const LivePair& pair : pairs) {
    const auto message = boost::make_shared<Pair>();
    message->header.stamp.fromSec(pair.stamp);
    message->header.frame_id = params_.base_frame;
    message->trajectory = trajectories_.at(pair.stamp);
    message->command = poseToMsg(pair.command);
    message->observation = poseToMsg(pair.observation);
    pairs_publisher_.publish(message);
    if (!recording_ || pair_order_.add(message->header.stamp) > 0.0) continue;
    ++pairs_;
    writer_->push(makeBagRecord<Pair>(topics::kPairs, ros::Time::now(), message));
  }
}

void Recorder::watchClock(const ros::Time& now) {
  const double back = (last_time_ - now).toSec();
  last_time_ = now;
  if (!ros::Time::isSimTime() || back < kClockTolerance) return;
  forgetSamples();
  trajectories_.clear();
  clock_message_ = format(
      "the clock jumped back by %.3f s: samples that waited for their partner "
      "were forgotten",
      back);
  ROS_WARN("recorder: %s", clock_message_.c_str());
}

void Recorder::forgetSamples() {
  synchroniser_.clear();
  watch_->clear();
  delay_.clear();
}

void Recorder::warnUnregistered(const std::string& topic, const std::string& frame) {
  unregistered_message_ =
      frame.empty()
          ? format("%s names no frame: set ~mocap_frame; recording goes on without pairs",
                   topic.c_str())
          : format(
                "tf does not know %s (of %s) in %s: start the driver that publishes it, or "
                "`rosrun tf2_ros static_transform_publisher X Y Z YAW PITCH ROLL %s %s`; "
                "recording goes on without pairs",
                frame.c_str(), topic.c_str(), params_.base_frame.c_str(),
                params_.base_frame.c_str(), frame.c_str());
  if (!last_warning_.isZero() && since(last_warning_) < kWarningPeriod) return;
  last_warning_ = ros::SteadyTime::now();
  ROS_WARN("recorder: %s", unregistered_message_.c_str());
}

// --- recording -----------------------------------------------------------------------------------

bool Recorder::running() const {
  return recording_ && writer_->progress().state == SessionWriter::State::kWriting;
}

std::string Recorder::newName() const {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "session_%Y%m%dT%H%M%SZ", &utc);
  std::string name = stamp;
  const auto taken = [&](const std::string& candidate) {
    for (const char* ending : {".bag", ".bag.active", "_0.bag", "_0.bag.active"})
      if (fs::exists(fs::path(params_.directory) / (candidate + ending))) return true;
    return false;
  };
  for (int i = 2; taken(name); ++i) name = format("%s_%d", stamp, i);
  return name;
}

std::string Recorder::start(const std::string& name) {
  SessionWriterOptions options;
  options.split_bytes = static_cast<std::uint64_t>(params_.split_size_mb * kMegabyte);
  options.split_duration = params_.split_duration;
  options.min_free_bytes = static_cast<std::uint64_t>(params_.min_free_mb * kMegabyte);
  options.queue_size = static_cast<std::size_t>(params_.queue_size);
  const fs::path path = fs::path(params_.directory) / (name.empty() ? newName() : expandHome(name));
  auto writer = std::make_unique<SessionWriter>(path.lexically_normal().string(), options);
  if (writer_) writer_->close();  // of a recording that ended by itself
  writer_ = std::move(writer);
  recording_ = true;
  started_ = ros::SteadyTime::now();
  completed_trajectories_ = 0;
  pairs_ = 0;
  pair_order_ = {};
  out_of_order_ = 0;
  order_message_.clear();
  clock_message_.clear();
  for (StreamState& stream : streams_) {
    stream.received = 0;
    stream.order = {};
  }
  forgetSamples();  // whatever their stamps were: a recording begins anew
  const ros::Time now = ros::Time::now();
  recordParameters(now);
  recordHoming(now);
  recordStaticTransforms(now);
  return writer_->progress().bag;
}

void Recorder::recordParameters(const ros::Time& time) {
  const auto text = boost::make_shared<std_msgs::String>();
  text->data = recorderParametersYaml(params_);
  writer_->pushSticky(
      makeBagRecord<std_msgs::String>(topics::kRecorderParameters, time, text, /*latched=*/true));
}

/// Before the first pose that needs it.
void Recorder::recordRegistration(const std::string& frame, const Pose& X_base_frame,
                                  const ros::Time& now) {
  const std::string name = withoutSlash(frame);
  if (name != params_.base_frame &&
      static_transforms_.setRegistration(params_.base_frame, name, X_base_frame, now))
    recordStaticTransforms(now);
}

void Recorder::recordStaticTransforms(const ros::Time& time) {
  if (!recording_ || static_transforms_.empty()) return;
  const auto all = boost::make_shared<tf2_msgs::TFMessage>(static_transforms_.message());
  writer_->pushSticky(
      makeBagRecord<tf2_msgs::TFMessage>(topics::kTfStatic, time, all, /*latched=*/true));
}

bool Recorder::onStart(StartRecording::Request& request, StartRecording::Response& response) {
  response.success = false;
  if (running()) {
    response.bag = writer_->progress().bag;
    response.message = "a recording is running: " + response.bag + "; call ~stop first";
    return true;
  }
  try {
    response.bag = start(request.bag);
    response.success = true;
    response.message = "writing " + response.bag;
    for (const std::string& finding : published_.findings)
      response.message += "; before the start: " + finding;
  } catch (const std::exception& e) {
    response.message = e.what();
  }
  ROS_LOG(response.success ? ros::console::levels::Info : ros::console::levels::Error,
          ROSCONSOLE_DEFAULT_NAME, "recorder: %s", response.message.c_str());
  publishStatus();
  return true;
}

bool Recorder::onStop(StopRecording::Request&, StopRecording::Response& response) {
  response.success = false;
  if (!recording_) {
    response.message = "no recording is running; call ~start first";
    return true;
  }
  const SessionWriter::Progress end = writer_->close();
  recording_ = false;
  duration_ = since(started_);
  response.success = end.state == SessionWriter::State::kClosed;
  response.message = end.message;
  if (end.dropped > 0)
    response.message += format(
        "; %lu messages were dropped because the disk was too slow: see "
        "~queue_size",
        static_cast<unsigned long>(end.dropped));
  if (out_of_order_ > 0)
    response.message +=
        format("; %lu messages were left out because their stamps went back, first on %s",
               static_cast<unsigned long>(out_of_order_), order_message_.c_str());
  response.bags = end.parts;
  response.trajectories = completed_trajectories_;
  response.pairs = pairs_;
  response.duration = duration_;
  ROS_INFO("recorder: %s: %s", end.bag.c_str(), response.message.c_str());
  publishStatus();
  return true;
}

}  // namespace raven_correction
