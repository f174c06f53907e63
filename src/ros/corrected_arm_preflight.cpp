// SPDX-License-Identifier: BSD-3-Clause
// What may be switched on, and the pre-flight that decides it: the part of CorrectedArm that waits.
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/ros/corrected_arm.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kDegree = 180.0 / 3.14159265358979323846;
constexpr double kLongest = 600.0;            // as of preflight_duration [s]
constexpr std::uint32_t kMostPoses = 100000;  // as of preflight_poses [1]

}  // namespace

/// The model that a pre-flight is about.
std::shared_ptr<const Correction> CorrectedArm::candidate() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return waiting_ != nullptr ? waiting_ : in_use_;
}

bool CorrectedArm::inUseIsCleared() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return in_use_ != nullptr && isCleared(gate_.of(in_use_->id));
}

/// Of several threads, without a lock around both: whoever writes last has seen what all know.
void CorrectedArm::updatePreflightState() {
  const auto now = [this] {
    const std::lock_guard<std::mutex> lock(mutex_);
    return gate_.of(in_use_ != nullptr ? in_use_->id : std::string());
  };
  PreflightState state;
  do {
    state = now();
    preflight_state_.store(state);
  } while (state != now());
}

void CorrectedArm::noteHoming(HomingWatch::Homing homing) noexcept {
  // What was seen is not made doubtful by a silence after it.
  if (homing_ != HomingWatch::Homing::kSeen || preflight_state_ != PreflightState::kNeeded)
    homing_.store(homing);
  HomingTimes& times = homing == HomingWatch::Homing::kSeen ? seen_homing_ : possible_homing_;
  // While a simulated clock has not begun, it is after everything that was recorded.
  const ros::Time now = ros::Time::now();
  times.at.store(now.isZero() ? std::numeric_limits<double>::infinity() : now.toSec());
  times.unix_time.store(ros::WallTime::now().toSec());
  gate_.noteHoming();
  if (!gate_.required()) return;
  corrector_.setMode(CorrectorMode::kOff);
  preflight_state_.store(PreflightState::kNeeded);
}

void CorrectedArm::boundHomings(double now) noexcept {
  for (HomingTimes* const times : {&seen_homing_, &possible_homing_})
    if (times->at > now) times->at.store(now);
}

std::string CorrectedArm::refusal(CorrectorMode mode, bool override_preflight) const {
  if (mode == CorrectorMode::kOff || !gate_.required()) return "";
  const std::shared_ptr<const Correction> model = candidate();
  const std::string whose = arm_.ns.empty() ? "" : " of " + arm_.ns;
  if (model == nullptr)
    return "there is no model" + whose +
           " yet that could pass a pre-flight: train or load one first";
  if (override_preflight || inUseIsCleared()) return "";
  return format(
      "model %s%s has not passed a pre-flight since this node started and the robot was homed, or "
      "its state was silent, last: call ~preflight while the robot makes a few moves in sight of "
      "motion capture, or take the "
      "responsibility with ~set_mode and override_preflight: true",
      model->id.c_str(), whose.c_str());
}

bool CorrectedArm::setMode(CorrectorMode mode, bool override_preflight) {
  const bool on = mode != CorrectorMode::kOff;
  const std::uint32_t offs = on ? offs_.load() : ++offs_;
  if (on && gate_.required() && override_preflight) {
    const std::uint32_t homings = gate_.homings();
    const std::shared_ptr<const Correction> model = candidate();
    if (model != nullptr && !isCleared(gate_.of(model->id))) {
      ROS_WARN("corrector: %s%sthe pre-flight of model %s is overridden", arm_.ns.c_str(),
               arm_.ns.empty() ? "" : ": ", model->id.c_str());
      settle(model, PreflightState::kOverridden, homings);
    }
  }
  corrector_.setMode(mode);
  // What has switched it off in between, before or after, wins.
  const bool in_force = !on || (offs_.load() == offs && (!gate_.required() || inUseIsCleared()));
  if (!in_force) corrector_.setMode(CorrectorMode::kOff);
  ROS_INFO("corrector: %s%smode %s", arm_.ns.c_str(), arm_.ns.empty() ? "" : ": ",
           correctorModeName(corrector_.mode()));
  return in_force;
}

/// The model may correct from now on, and is in use.
void CorrectedArm::settle(const std::shared_ptr<const Correction>& model, PreflightState how,
                          std::uint32_t homings) {
  const std::lock_guard<std::mutex> one_at_a_time(model_mutex_);
  gate_.clear(model->id, how, homings);
  bool waits = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    waits = waiting_ == model;
  }
  if (waits)
    useModel(model);
  else
    updatePreflightState();
}

void CorrectedArm::preflight(const Preflight::Request& request, Preflight::Response& response) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (double* const value : {&response.position_median_mm, &response.orientation_median_deg,
                              &response.position_expected_mm, &response.orientation_expected_deg,
                              &response.position_limit_mm, &response.orientation_limit_deg,
                              &response.position_before_mm, &response.orientation_before_deg})
    *value = none;
  if (!(request.duration >= 0.0 && request.duration <= kLongest) || request.poses > kMostPoses) {
    response.message = format("duration %g s and %u poses: at most %g s and %u", request.duration,
                              request.poses, kLongest, kMostPoses);
    return;
  }
  const std::shared_ptr<const Correction> model = candidate();
  if (model == nullptr) {
    response.message = "there is no model to judge; train or load one first";
    return;
  }
  response.model = model->id;
  const std::uint32_t homings = gate_.homings();
  const std::size_t poses =
      request.poses > 0 ? request.poses : static_cast<std::size_t>(params_.preflight_poses);
  const double duration = request.duration > 0.0 ? request.duration : params_.preflight_duration;
  ROS_INFO("corrector: pre-flight of model %s, at most %.0f s", model->id.c_str(), duration);
  const ArmObserver::Moves moves = observer_.observe(duration, poses, params_.preflight.min_extent);
  response.seconds = moves.seconds;
  for (const StreamFinding& finding : moves.findings) response.findings.push_back(toText(finding));
  PreflightResult result;
  result.message = moves.problem;
  if (moves.problem.empty())
    result = judgePreflight(*model, moves.commands, moves.observations, params_.preflight);
  using Status = PreflightResult::Status;
  // Streams that are not what they are taken for prove nothing, whatever the numbers are.
  if (result.status == Status::kPassed && anyError(moves.findings)) {
    result.status = Status::kFailed;
    result.message += "; but the streams are not to be trusted: " + response.findings.front();
  }
  if (result.status == Status::kPassed && gate_.homings() != homings) {
    result.status = Status::kNotObserved;
    result.message = "the robot was homed meanwhile, or its state was silent: once more";
  }
  response.message = result.message;
  response.poses = static_cast<std::uint32_t>(result.poses);
  response.position_median_mm = 1e3 * result.position;
  response.orientation_median_deg = kDegree * result.angle;
  response.position_expected_mm = 1e3 * result.promised_position;
  response.orientation_expected_deg = kDegree * result.promised_angle;
  response.position_limit_mm = 1e3 * result.max_position;
  response.orientation_limit_deg = kDegree * result.max_angle;
  response.position_before_mm = 1e3 * result.uncorrected_position;
  response.orientation_before_deg = kDegree * result.uncorrected_angle;
  response.success = result.status == Status::kPassed || result.status == Status::kFailed;
  response.passed = result.status == Status::kPassed;
  if (response.passed) settle(model, PreflightState::kPassed, homings);
  if (result.status == Status::kFailed) {
    gate_.revoke(model->id);
    updatePreflightState();
    if (gate_.required() && !inUseIsCleared() && corrector_.mode() != CorrectorMode::kOff) {
      corrector_.setMode(CorrectorMode::kOff);
      response.message += "; the correction was switched off";
    }
  }
  ROS_LOG(response.passed ? ros::console::levels::Info : ros::console::levels::Warn,
          ROSCONSOLE_DEFAULT_NAME, "corrector: pre-flight %s: %s",
          response.passed ? "passed" : "not passed", response.message.c_str());
  const std::lock_guard<std::mutex> lock(mutex_);
  last_preflight_ = (response.passed    ? "passed: "
                     : response.success ? "failed: "
                                        : "not done: ") +
                    response.message;
}

/// With mutex_ held.
void CorrectedArm::diagnosePreflight(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const PreflightState state = preflight_state_;
  status.add("pre-flight", preflightStateName(state));
  status.add("last pre-flight", last_preflight_.empty() ? "none" : last_preflight_);
  if (waiting_ != nullptr) {
    status.add("model that waits", waiting_->id);
    status.mergeSummary(Level::WARN, "model " + waiting_->id + " waits for its pre-flight");
  }
  if (state == PreflightState::kOverridden)
    status.mergeSummary(Level::WARN, "the pre-flight of the model in use was overridden");
  if (state == PreflightState::kNeeded && homing_ != HomingWatch::Homing::kNone)
    status.mergeSummaryf(Level::WARN,
                         "the robot %s: the correction is off until a pre-flight has passed",
                         homingText(homing_));
}

std::vector<TopicType> CorrectedArm::expectedTopics() const {
  std::vector<TopicType> expected;
  if (measured_subscriber_) expected.push_back({measured_subscriber_.getTopic(), ""});
  if (gate_.required())
    expected.push_back({observer_.mocapTopic(), "geometry_msgs/" + params_.mocap_pose_type});
  return expected;
}

}  // namespace raven_correction
