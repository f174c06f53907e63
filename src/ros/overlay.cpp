// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/overlay.h"

#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/pose_subscription.h"
#include "raven_correction/ros/topics.h"
#include "raven_correction/ros/training_markers.h"

namespace raven_correction {
namespace {

constexpr double kWarningPeriod = 10.0;   // [s]
constexpr double kClockTolerance = 0.01;  // a smaller step back is jitter [s]
constexpr double kPacePeriod = 1.0;       // over which rate and latency are taken [s]
constexpr std::uint32_t kQueue = 2000;

}  // namespace

OverlayParams loadOverlayParams(const ros::NodeHandle& nh) {
  OverlayParams params;
  std::vector<std::string> mocap_types = poseTypes();
  mocap_types.insert(mocap_types.begin(), "same");
  ParamReader read(nh, "overlay");
  read.text("base_frame", params.base_frame);
  read.oneOf("pose_type", params.pose_type, poseTypes());
  read.oneOf("mocap_pose_type", params.mocap_pose_type, mocap_types);
  read.text("mocap_frame", params.mocap_frame);
  read.number("rate", params.rate, 1.0, 60.0);
  read.number("max_age", params.max_age, 0.1, 60.0);
  read.number("delay", params.history.delay, 0.0, 1.0);
  read.number("trail_duration", params.history.trail_duration, 0.0, 120.0);
  read.number("error_duration", params.history.error_duration, 0.0, 3600.0);
  read.number("error_period", params.history.error_period, 0.02, 60.0);
  read.positive("axis_length", params.style.axis_length, 1.0);
  read.positive("text_height", params.style.text_height, 1.0);
  read.number("exaggeration", params.style.exaggeration, 1.0, 100.0);
  read.positive("error_scale", params.style.error_scale, 1.0);
  read.refuseUnknownKeys();
  read.throwIfAnyProblem();
  params.base_frame = withoutSlash(params.base_frame);
  if (params.base_frame.empty())
    throw InvalidInput("overlay: ~base_frame is empty; give the frame of servo_cp, e.g. 0_link");
  if (params.mocap_pose_type == "same") params.mocap_pose_type = params.pose_type;
  params.style.frame = params.base_frame;
  params.style.lifetime = std::max(1.0, 5.0 / params.rate);  // outlives four lost messages
  ROS_INFO_STREAM(read.summary());
  return params;
}

Overlay::Overlay(ros::NodeHandle nh, const OverlayParams& params)
    : nh_(std::move(nh)),
      params_(params),
      registration_(params.base_frame),
      history_(params.history) {
  publisher_ = nh_.advertise<visualization_msgs::MarkerArray>(topics::kOverlay, 2);
  training_publisher_ =
      nh_.advertise<visualization_msgs::MarkerArray>(topics::kOverlayModel, 1, true);
  const auto pose = [&](const char* topic, const std::string& type, auto callback) {
    subscribers_.push_back(
        subscribePose(nh_, topic, type, kQueue,
                      [this, callback](const auto& message) { (this->*callback)(message); }));
  };
  pose(topics::kDesired, params.pose_type, &Overlay::onDesired);
  pose(topics::kCommand, params.pose_type, &Overlay::onCommand);
  pose(topics::kMocap, params.mocap_pose_type, &Overlay::onObserved);
  subscribers_.push_back(nh_.subscribe(topics::kStatus, kQueue, &Overlay::onStatus, this));
  subscribers_.push_back(nh_.subscribe(topics::kModel, 1, &Overlay::onModel, this));
  subscribers_.push_back(nh_.subscribe(topics::kSamples, 1, &Overlay::onSamples, this));
  std::string names = "overlay: listens to";
  for (const ros::Subscriber& subscriber : subscribers_) names += " " + subscriber.getTopic();
  ROS_INFO_STREAM(names << ", publishes " << publisher_.getTopic());
  timer_ = nh_.createWallTimer(ros::WallDuration(1.0 / params.rate),
                               [this](const ros::WallTimerEvent&) { onTimer(); });
}

std::optional<StampedPose> Overlay::inBase(const char* topic,
                                           const geometry_msgs::PoseStamped& message,
                                           const std::string& default_frame) {
  watchClock();
  const std::string& given = message.header.frame_id;
  const std::string& frame = given.empty() ? default_frame : given;
  const auto X_base_frame = registration_.find(frame);
  if (!X_base_frame) {
    unregistered_[topic] = frame.empty() ? format("%s names no frame: set ~mocap_frame", topic)
                                         : format("%s: tf does not know %s in %s", topic,
                                                  frame.c_str(), params_.base_frame.c_str());
    ROS_WARN_THROTTLE(kWarningPeriod, "overlay: %s; it is not shown", unregistered_[topic].c_str());
    return std::nullopt;
  }
  unregistered_.erase(topic);
  StampedPose sample = stampedPoseFromMsg(message);
  sample.pose = *X_base_frame * sample.pose;
  if (!isFinite(sample.pose) || !hasUnitQuaternion(sample.pose)) return std::nullopt;
  return sample;
}

void Overlay::onDesired(const geometry_msgs::PoseStampedConstPtr& message) {
  const auto sample = inBase(topics::kDesired, *message, params_.base_frame);
  if (!sample) return;
  desired_ = Shown{sample->pose, ros::SteadyTime::now()};
  history_.addDesired(*sample);
}

void Overlay::onCommand(const geometry_msgs::PoseStampedConstPtr& message) {
  const auto sample = inBase(topics::kCommand, *message, params_.base_frame);
  if (!sample) return;
  command_ = Shown{sample->pose, ros::SteadyTime::now()};
  history_.addCommand(*sample);
}

void Overlay::onObserved(const geometry_msgs::PoseStampedConstPtr& message) {
  const auto sample = inBase(topics::kMocap, *message, params_.mocap_frame);
  if (!sample) return;
  observed_ = Shown{sample->pose, ros::SteadyTime::now()};
  history_.addObserved(*sample);
}

void Overlay::onStatus(const CorrectionStatusConstPtr& message) {
  status_ = message;
  status_arrived_ = ros::SteadyTime::now();
  pace_.add(status_arrived_, message->compute_time);
  history_.addStatus(message->header.stamp.toSec(), isCorrectedCode(message->code));
}

void Overlay::Pace::add(const ros::SteadyTime& now, double compute_time) {
  if (since.isZero() || (now - since).toSec() > 2.0 * kPacePeriod) *this = Pace{now};
  ++count;
  worst = std::max(worst, compute_time);
  const double elapsed = (now - since).toSec();
  if (elapsed < kPacePeriod) return;
  rate = count / elapsed;
  slowest = worst;
  since = now;
  count = 0;
  worst = 0.0;
}

void Overlay::onModel(const CorrectionModelConstPtr& message) {
  model_ = message;
  history_.setDelay(message->delay);
  drawTraining();
}

void Overlay::onSamples(const TrainingSamplesConstPtr& message) {
  samples_ = message;
  drawTraining();
}

/// Samples of another training than that of the model are drawn, too: they may be of one that was
/// not better.
void Overlay::drawTraining() {
  std::optional<Predictor> predictor;
  try {
    if (model_) predictor.emplace(modelFromMsg(*model_));
  } catch (const InvalidInput& error) {
    ROS_WARN("overlay: the model's error field is not drawn: %s", error.what());
  }
  if (samples_ && samples_->header.frame_id != params_.base_frame)
    ROS_WARN("overlay: training samples are in %s, not in %s; they are not drawn",
             samples_->header.frame_id.c_str(), params_.base_frame.c_str());
  const bool here = samples_ && samples_->header.frame_id == params_.base_frame;
  training_publisher_.publish(makeTrainingMarkers(
      here ? samples_.get() : nullptr, predictor ? &*predictor : nullptr, params_.style));
}

void Overlay::watchClock() {
  const ros::Time now = ros::Time::now();
  const double back = (last_time_ - now).toSec();
  last_time_ = now;
  if (!ros::Time::isSimTime() || back < kClockTolerance) return;
  history_.clear();
  desired_.reset();
  command_.reset();
  observed_.reset();
  ROS_WARN("overlay: the clock jumped back by %.3f s: trails and errors were cleared", back);
}

bool Overlay::recent(const ros::SteadyTime& arrived) const {
  return !arrived.isZero() && (ros::SteadyTime::now() - arrived).toSec() <= params_.max_age;
}

std::optional<Pose> Overlay::recentPose(const std::optional<Shown>& shown) const {
  if (!shown || !recent(shown->arrived)) return std::nullopt;
  return shown->pose;
}

std::vector<std::string> Overlay::statusLines() const {
  std::vector<std::string> lines;
  if (recent(status_arrived_))
    lines.push_back("mode " + status_->mode + ": " + correctionCodeName(status_->code));
  else
    lines.push_back(status_ ? "corrector: silent" : "no corrector");
  if (recent(status_arrived_) && pace_.rate > 0.0)
    lines.push_back(
        format("%.0f poses per second, at most %.0f us each", pace_.rate, 1e6 * pace_.slowest));
  lines.push_back(model_ ? "model " + model_->id : "no model");
  for (const bool corrected : {false, true}) {
    const MeanError mean = history_.mean(corrected);
    if (mean.samples == 0) continue;
    lines.push_back((corrected ? "mean corrected: " : "mean uncorrected: ") +
                    errorText(mean.position, mean.angle));
  }
  for (const auto& [topic, problem] : unregistered_) lines.push_back(problem);
  return lines;
}

void Overlay::onTimer() {
  watchClock();
  if (publisher_.getNumSubscribers() == 0) return;
  OverlayView view;
  view.desired = recentPose(desired_);
  view.command = recentPose(command_);
  view.observed = recentPose(observed_);
  const auto& error = history_.latest();  // of a while ago where nothing is wanted any more
  if (view.observed && error &&
      history_.observed().back().stamp - error->stamp < history_.delay() + params_.max_age) {
    view.error = error;
    view.observed = error->observed;
    if (view.desired) view.desired = error->desired;
    if (view.command) view.command = history_.commandAt(error->stamp - history_.delay());
  }
  if (recent(status_arrived_) && isCorrectedCode(status_->code))
    view.sd_position = vectorFromMsg(status_->sd_position);
  if (model_) {
    const auto& low = model_->workspace_min;
    const auto& high = model_->workspace_max;
    view.workspace = OverlayBox{{low.x, low.y, low.z}, {high.x, high.y, high.z}};
  }
  view.status = statusLines();
  publisher_.publish(makeOverlay(view, history_, params_.style));
}

}  // namespace raven_correction
