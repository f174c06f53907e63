// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/corrected_arm.h"

#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/pose_subscription.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

/// A longer id of a model costs the first statuses that name it an allocation each.
constexpr std::size_t kLongestModelId = 256;
constexpr double kMasterSilence = 5.0;  ///< of the master, that is worth a warning [s]
constexpr double kSameHoming = 10.0;    ///< two nodes see one homing within this time [s]

CorrectorLimits limitsOf(const CorrectorParams& params, const CorrectedArmParams& arm) {
  CorrectorLimits limits = params.limits;
  if (arm.robot.empty()) return limits;
  auto chain = std::make_shared<KinematicChain>(loadKinematicChain(arm.robot));
  if (!sameName(chain->frame(), params.base_frame))
    throw InvalidInput(format("corrector: %s is a robot in the frame \"%s\", ~base_frame is \"%s\"",
                              arm.robot.c_str(), chain->frame().c_str(),
                              params.base_frame.c_str()));
  limits.robot.chain = std::move(chain);
  return limits;
}

}  // namespace

CorrectedArm::CorrectedArm(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                           const CorrectorParams& params, const CorrectedArmParams& arm,
                           ros::CallbackQueueInterface& live_queue,
                           ros::CallbackQueueInterface& model_queue,
                           ros::CallbackQueueInterface& check_queue)
    : nh_(nh, arm.ns),
      params_(params),
      arm_(arm),
      corrector_(limitsOf(params, arm)),
      master_heard_at_(ros::SteadyTime::now().toSec()),
      gate_(params.require_preflight),
      preflight_state_(params.require_preflight ? PreflightState::kNeeded
                                                : PreflightState::kNotRequired),
      observer_(nh_, params, check_queue),
      reported_at_(ros::SteadyTime::now()),
      diagnostics_(nh, private_nh, private_nh.getNamespace()) {
  corrector_.setTuning(params.gain, params.limits.max_translation, params.limits.max_rotation);
  if (!arm.model.empty()) takeModel(std::make_shared<const Correction>(readModelFile(arm.model)));
  setMode(params.enabled ? correctorModeFromName(params.mode) : CorrectorMode::kOff, false);
  CorrectionStatus longest;
  longest.header.frame_id = params.base_frame;
  longest.model.assign(kLongestModelId, ' ');
  statuses_.makeRoomFor(longest);
  status_publisher_ = nh_.advertise<CorrectionStatus>(topics::kStatus, 100);
  diagnostics_.setHardwareID("none");
  diagnostics_.add(arm.ns.empty() ? "correction" : "correction " + arm.ns, this,
                   &CorrectedArm::diagnose);

  ros::NodeHandle live(nh_);
  live.setCallbackQueue(&live_queue);
  path_subscriber_ = live.subscribe(topics::kDesiredPath, 1, &CorrectedArm::onPath, this);
  if (params.limits.robot.max_step > 0.0 || params.limits.robot.max_turn > 0.0)
    measured_subscriber_ = subscribePose(
        live, topics::kEncoder,
        params.pose_type == "TransformStamped" ? "TransformStamped" : "PoseStamped", 1,
        [this](const geometry_msgs::PoseStampedConstPtr& measured) { onMeasured(measured); });
  ros::NodeHandle slow(nh_);
  slow.setCallbackQueue(&model_queue);
  model_subscriber_ = slow.subscribe(topics::kModel, 1, &CorrectedArm::onModel, this);
  diagnostics_timer_ = nh_.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  ROS_INFO("corrector: model from %s, status on %s", model_subscriber_.getTopic().c_str(),
           status_publisher_.getTopic().c_str());
}

// --- live ----------------------------------------------------------------------------------------

std::optional<CorrectorCode> CorrectedArm::fault(const ArmRequest& request, double stamp,
                                                 double now) const noexcept {
  Pose asked;  // a part that is not asked for may hold anything
  if (request.position) asked.p = request.pose.p;
  if (request.orientation) asked.q = request.pose.q;
  return corrector_.fault(stamp, now, asked);
}

CorrectorOutput CorrectedArm::prepare(const ArmRequest& request, double stamp,
                                      double now) noexcept {
  prepared_ = request.kind != ArmRequest::Kind::kInactive;
  next_known_ = known_;
  if (followed_) path_.undo();  // the last one was not sent
  followed_ = false;
  CorrectorOutput output;
  if (!prepared_) {
    output.command = request.pose;
    output.code = CorrectorCode::kPassedInactive;
    output.mode = corrector_.mode();
    return output;
  }
  // Increments add up in the controller: after one, that part is not known any more.
  const bool position = request.position && !request.position_relative;
  const bool orientation = request.orientation && !request.orientation_relative;
  if (request.position) next_known_.position = position;
  if (request.orientation) next_known_.orientation = orientation;
  if (position) next_known_.pose.p = request.pose.p;
  if (orientation) next_known_.pose.q = request.pose.q;
  if (!next_known_.position || !next_known_.orientation)
    return corrector_.prepareParts(stamp, now, request.pose, position, orientation);
  Lookahead ahead;
  const Lookahead* const announced = lookAhead(stamp, next_known_.pose, ahead);
  output =
      corrector_.prepare(stamp, now, next_known_.pose, isEndpoint(next_known_.pose), announced);
  if (!request.position) output.command.p = request.pose.p;
  if (!request.orientation) output.command.q = request.pose.q;
  return output;
}

void CorrectedArm::commit(bool sent) noexcept {
  if (prepared_) corrector_.commit();
  prepared_ = false;
  if (sent) followed_ = false;
  if (sent) known_ = next_known_;
}

void CorrectedArm::report(const CommandRequest& message, double now, const ArmRequest& request,
                          const CorrectorOutput& output, double compute_time) {
  ++counts_[static_cast<std::size_t>(output.code)];
  latency_.add(compute_time);
  if (output.distance > distance_.load(std::memory_order_relaxed))
    distance_.store(output.distance, std::memory_order_relaxed);
  if ((output.limits & kPlannerBeyond) != 0) ++beyond_;
  if (output.ahead) ++ahead_;
  if (!isRefused(output.code)) tool_known_by_.store(output.tool_known_by);
  const boost::shared_ptr<CorrectionStatus> status = statuses_.next();
  status->header.stamp = message.stamp;
  status->header.frame_id = params_.base_frame;
  status->code = static_cast<std::uint8_t>(output.code);
  // A message that was refused before the arms were asked knows no mode.
  status->mode = correctorModeName(isRefused(output.code) ? corrector_.mode() : output.mode);
  status->gain = output.gain;
  if (output.model != nullptr)
    status->model = *output.model;
  else
    status->model.clear();
  status->desired = poseToMsg(request.pose);
  status->command = isRefused(output.code) ? geometry_msgs::Pose() : poseToMsg(output.command);
  status->sd_position = vectorToMsg(output.sd_position);
  status->sd_rotation = vectorToMsg(output.sd_rotation);
  status->limits = output.limits;
  status->h_share = output.h_share;
  status->compute_time = compute_time;
  status->preflight = static_cast<std::uint8_t>(preflight_state_.load());
  status_publisher_.publish(status);
  if (request.kind != ArmRequest::Kind::kPose || !request.position || !request.orientation) return;
  LiveSample sample;
  sample.stamp = message.stamp.toSec();
  sample.arrival = now;
  sample.desired = request.pose;
  sample.command = output.command;
  sample.sent = !isRefused(output.code);
  sample.setFrame(message.frame);
  observer_.note(sample);
}

void CorrectedArm::restart() noexcept {
  corrector_.restart();
  known_ = {};
  path_.begin();  // its ends are known still
  followed_ = false;
}

void CorrectedArm::forgetPath() noexcept {
  has_path_ = followed_ = false;
  path_.begin();
}

/// Where the tool is to be when a command of now has its effect. Null where nobody has said.
const Lookahead* CorrectedArm::lookAhead(double stamp, const Pose& desired,
                                         Lookahead& ahead) noexcept {
  if (!params_.lookahead || !has_path_) return nullptr;
  path_.follow(stamp, desired);
  followed_ = true;
  const std::optional<double> delay = corrector_.modelDelay();
  if (!delay || !(*delay > 0.0)) return nullptr;
  const std::optional<Pose> pose = path_.ahead(*delay);
  if (!pose) return nullptr;
  ahead = {stamp + *delay, *pose};
  return &ahead;
}

bool CorrectedArm::isEndpoint(const Pose& desired) const noexcept {
  if (!has_path_) return false;
  return isPathPose(desired, path_first_) || isPathPose(desired, path_last_);
}

void CorrectedArm::onPath(const geometry_msgs::PoseArray& path) {
  forgetPath();
  const std::string& frame = path.header.frame_id;
  has_path_ = !path.poses.empty() &&
              (sameName(frame, params_.base_frame) || (frame.empty() && params_.allow_empty_frame));
  if (!has_path_) return;
  path_first_ = poseFromMsg(path.poses.front());
  path_last_ = poseFromMsg(path.poses.back());
  if (!params_.lookahead) return;
  for (const geometry_msgs::Pose& pose : path.poses) path_.add(poseFromMsg(pose));
}

void CorrectedArm::onMeasured(const geometry_msgs::PoseStampedConstPtr& measured) {
  const std::string& frame = measured->header.frame_id;
  if (!sameName(frame, params_.base_frame) && !(frame.empty() && params_.allow_empty_frame)) return;
  corrector_.setMeasured(measured->header.stamp.toSec(), ros::Time::now().toSec(),
                         poseFromMsg(measured->pose));
}

// --- told by others ------------------------------------------------------------------------------

/// While a model that has passed its pre-flight is in use, another one waits until it has, too: the
/// correction that was checked goes on.
void CorrectedArm::takeModel(std::shared_ptr<const Correction> model) {
  checkModelIsFor(*model, params_, arm_, ros::WallTime::now().toSec());
  const std::lock_guard<std::mutex> one_at_a_time(model_mutex_);
  const bool other = gate_.required() && !isCleared(gate_.of(model->id)) && inUseIsCleared();
  if (!other) return useModel(model);
  const Predictor check(*model);  // refuses what does not fit together
  ROS_WARN("corrector: model %s waits for its pre-flight; the one in use goes on",
           model->id.c_str());
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_ = std::move(model);
  refusal_.clear();
}

/// With model_mutex_ held.
void CorrectedArm::useModel(const std::shared_ptr<const Correction>& model) {
  corrector_.setModel(*model);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    model_ = {model->id, model->trained_at, model->homed_at, model->expires_at};
    in_use_ = model;
    waiting_.reset();
    refusal_.clear();
  }
  updatePreflightState();
  ROS_INFO("corrector: model %s is in use", model->id.c_str());
}

void CorrectedArm::onModel(const CorrectionModel& msg) {
  try {
    takeModel(std::make_shared<const Correction>(modelFromMsg(msg)));
  } catch (const std::exception& error) {
    ROS_ERROR("corrector: model refused, the one before stays in use: %s", error.what());
    const std::lock_guard<std::mutex> lock(mutex_);
    refusal_ = error.what();
  }
}

bool CorrectedArm::hasModel() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !model_.id.empty();
}

void CorrectedArm::noteTopics(const std::vector<StreamFinding>& findings) {
  const std::lock_guard<std::mutex> lock(mutex_);
  topic_findings_ = findings;
}

// --- diagnostics ---------------------------------------------------------------------------------

void CorrectedArm::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  std::array<std::uint64_t, kCodes> recent{};
  std::uint64_t all = 0, refused = 0, passed = 0;
  for (std::size_t i = 0; i < kCodes; ++i) {
    const std::uint64_t total = counts_[i];
    recent[i] = total - reported_[i];
    reported_[i] = total;
    all += recent[i];
    const auto code = static_cast<CorrectorCode>(i);
    if (isRefused(code)) refused += recent[i];
    if (code >= CorrectorCode::kPassedOff && !isRefused(code)) passed += recent[i];
    if (total > 0) status.add(correctorCodeName(code), std::to_string(total));
  }
  const auto of = [&](CorrectorCode code) { return recent[static_cast<std::size_t>(code)]; };
  const ros::SteadyTime now = ros::SteadyTime::now();
  const double seconds = (now - reported_at_).toSec();
  reported_at_ = now;
  const auto share = [&](std::uint64_t count) {
    return format("%.3f", all > 0 ? static_cast<double>(count) / static_cast<double>(all) : 0.0);
  };
  const LatencyHistogram::Snapshot latency = latency_.take();
  const double unix_time = ros::WallTime::now().toSec();
  const std::uint64_t beyond = beyond_.exchange(0), ahead = ahead_.exchange(0);
  status.add("mode", correctorModeName(corrector_.mode()));
  status.add("input rate [1/s]", format("%.1f", static_cast<double>(all) / seconds));
  status.add("latency p50, p99, p99.9, max [us]",
             format("%.0f, %.0f, %.0f, %.0f", 1e6 * latency.p50, 1e6 * latency.p99,
                    1e6 * latency.p999, 1e6 * latency.max));
  status.add("share limited", share(of(CorrectorCode::kCorrectedLimited)));
  status.add("share refused", share(refused));
  status.add("share of poses beyond the robot's step", share(beyond));
  status.add("share corrected for the announced pose ahead", share(ahead));
  const ToolKnownBy tool = tool_known_by_;
  status.add("tool known by", toolKnownByName(tool));
  status.add("furthest from the trained region [m]", format("%.4f", distance_.exchange(0.0)));
  status.add("model", model_.id.empty() ? "none" : model_.id);
  if (model_.trained_at > 0.0)
    status.add("model age [h]", format("%.1f", (unix_time - model_.trained_at) / 3600.0));

  if (of(CorrectorCode::kPassedModelFault) > 0)
    status.summaryf(Level::ERROR, "the model answered %lu poses with numbers that are not finite",
                    of(CorrectorCode::kPassedModelFault));
  else if (corrector_.hold() == CorrectionHold::kOtherPublisher)
    status.summary(Level::ERROR, "somebody else publishes commands: nothing is corrected");
  else if (all == 0)
    status.summary(Level::OK, "the planner is silent");
  else if (refused > 0)
    status.summaryf(Level::WARN, "%lu of %lu poses refused", refused, all);
  else
    status.summaryf(Level::OK, "%lu poses: %lu passed unchanged, %lu limited", all, passed,
                    of(CorrectorCode::kCorrectedLimited));
  const double silence = now.toSec() - master_heard_at_;
  if (params_.watch_output && silence > kMasterSilence)
    status.mergeSummaryf(Level::WARN,
                         "the master has not answered for %.0f s: who else publishes commands is "
                         "not known",
                         silence);
  if (corrector_.hold() == CorrectionHold::kRobotNotReady)
    status.mergeSummary(Level::WARN, "the robot is not enabled and homed: nothing is corrected");
  if (all > 0 && (tool == ToolKnownBy::kLastCommand || tool == ToolKnownBy::kNothing))
    status.mergeSummaryf(
        Level::WARN, "no fresh %s says where the tool is: the robot's step is taken from the %s",
        measured_subscriber_.getTopic().c_str(),
        tool == ToolKnownBy::kNothing ? "next command on" : "last command");
  if (beyond > 0)
    status.mergeSummary(Level::WARN, "the planner's poses are further than the robot's step");
  if (!refusal_.empty()) status.mergeSummary(Level::WARN, "a model was refused: " + refusal_);
  if (model_.expires_at > 0.0 && unix_time > model_.expires_at)
    status.mergeSummary(Level::WARN, "the model has expired");
  // A model knows of the homing that it was recorded after, or at least when it was trained.
  const bool by_recording = model_.homed_at > 0.0;
  const double known = by_recording ? model_.homed_at : model_.trained_at;
  const auto homedSince = [&](const HomingTimes& times) {
    return (by_recording ? times.at : times.unix_time) > known + kSameHoming;
  };
  const bool proven = preflight_state_ == PreflightState::kPassed;  // since then
  const bool seen = homedSince(seen_homing_);
  if ((seen || homedSince(possible_homing_)) && !model_.id.empty() && !proven)
    status.mergeSummaryf(
        Level::WARN, "after the model was %s the robot %s", by_recording ? "recorded" : "trained",
        homingText(seen ? HomingWatch::Homing::kSeen : HomingWatch::Homing::kPossible));
  diagnosePreflight(status);
  std::vector<StreamFinding> findings = topic_findings_;
  for (const StreamFinding& finding : observer_.findings()) findings.push_back(finding);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    status.add(format("finding %zu", i + 1), toText(findings[i]));
    const bool said =
        findings[i].severity == StreamFinding::Severity::kError || findings[i].what == "missing";
    if (said) status.mergeSummary(Level::WARN, toText(findings[i]));
  }
}

}  // namespace raven_correction
