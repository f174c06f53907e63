// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/trainer_node.h"

#include <filesystem>
#include <limits>
#include <map>

#include "raven_correction/TrainingSamples.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/arm_kinematics.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = 180.0 / 3.14159265358979323846;
constexpr double kReading = 0.05;  // share of the work that is done after reading [-]
constexpr double kTrained = 0.97;  // and after training and validating [-]

template <typename Array>
void copyComponents(const ErrorSummary& summary, Array& position, Array& angle) {
  for (Eigen::Index k = 0; k < 3; ++k) {
    position[static_cast<std::size_t>(k)] = summary.mean_abs(k);
    angle[static_cast<std::size_t>(k)] = summary.mean_abs(3 + k);
  }
}

constexpr std::size_t kShownSamples = 3000;  // of a kind: for eyes

/// What eyes can take in of the samples: of each fate at most kShownSamples, evenly.
TrainingSamples samplesToMsg(const TrainingResult& training) {
  TrainingSamples msg;
  msg.header.stamp.fromSec(training.model.trained_at);
  msg.header.frame_id = training.model.frame;
  msg.model = training.model.id;
  std::map<Fate, std::vector<const PlacedSample*>> of_fate;
  for (const PlacedSample& sample : training.samples) of_fate[sample.fate].push_back(&sample);
  for (const auto& [fate, samples] : of_fate) {
    const bool kept = fate == Fate::kKept;
    if (kept) {
      msg.kept_count = static_cast<std::uint32_t>(samples.size());
    } else {
      msg.reason_names.push_back(fateName(fate));
      msg.reason_counts.push_back(static_cast<std::uint32_t>(samples.size()));
    }
    const std::size_t shown = std::min(samples.size(), kShownSamples);
    for (std::size_t i = 0; i < shown; ++i) {
      const geometry_msgs::Point point = pointToMsg(samples[i * samples.size() / shown]->position);
      (kept ? msg.kept : msg.rejected).push_back(point);
      if (!kept) msg.reasons.push_back(static_cast<std::uint8_t>(msg.reason_names.size() - 1));
    }
  }
  return msg;
}

}  // namespace

TrainerParams loadTrainerParams(const ros::NodeHandle& nh) {
  TrainerParams params;
  ParamReader read(nh, "trainer");
  read.text("data_directory", params.data_directory);
  read.text("model_directory", params.model_directory);
  read.text("configuration", params.configuration);
  read.text("model", params.model);
  read.text("arm", params.arm);
  read.text("tool", params.tool);
  read.text("pose_type", params.pose_type);
  read.text("robot", params.robot);
  read.text("play_robot", params.play_robot);
  read.texts("other_robots", params.other_robots);
  read.number("valid_hours", params.valid_hours, 0.0, 1e5);
  read.refuseUnknownKeys();
  read.throwIfAnyProblem();
  ROS_INFO("%s", read.summary().c_str());
  params.data_directory = expandHome(params.data_directory);
  params.model_directory = expandHome(params.model_directory);
  params.configuration = params.configuration.empty() ? packageFile("config/trainer.yaml")
                                                      : expandHome(params.configuration);
  params.model = expandHome(params.model);
  return params;
}

TrainerNode::TrainerNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh),
      private_nh_(private_nh),
      params_(loadTrainerParams(private_nh)),
      work_(private_nh_, "a training", "~retrain") {
  // Mistakes in files are better found now than later.
  configurationFrom(params_.configuration);
  loadArms(params_.robot, params_.other_robots, "");
  model_publisher_ = nh_.advertise<CorrectionModel>(topics::kModel, 1, true);
  samples_publisher_ = nh_.advertise<TrainingSamples>(topics::kSamples, 1, true);
  report_publisher_ = private_nh_.advertise<TrainingReport>("report", 1, true);
  if (!params_.model.empty()) goLive(readModelFile(params_.model));
  retrain_service_ = private_nh_.advertiseService("retrain", &TrainerNode::onRetrain, this);
  rollback_service_ = private_nh_.advertiseService("rollback", &TrainerNode::onRollback, this);
  load_service_ = private_nh_.advertiseService("load", &TrainerNode::onLoad, this);
  save_service_ = private_nh_.advertiseService("save", &TrainerNode::onSave, this);
  ROS_INFO("trainer: model on %s, retrain with %s", model_publisher_.getTopic().c_str(),
           retrain_service_.getService().c_str());
}

TrainingConfig TrainerNode::configurationFrom(const std::string& file) const {
  TrainingConfig config = loadTrainingConfig(file);
  if (!params_.play_robot.empty()) knowRobot(expandHome(params_.play_robot), config.motion);
  return config;
}

void TrainerNode::goLive(const Correction& model) {
  const std::lock_guard<std::mutex> lock(mutex_);
  publishLive(model);
}

/// mutex_ is held.
void TrainerNode::publishLive(const Correction& model) {
  live_.push_back(model);
  model_publisher_.publish(modelToMsg(model));
  ROS_INFO("trainer: model %s is live", model.id.c_str());
}

/// Unless another model went live since the one that this one was compared with. @return why not
std::string TrainerNode::goLiveInsteadOf(const std::string& before, const Correction& model,
                                         bool force) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string now = live_.empty() ? "" : live_.back().id;
  if (now != before && !force)
    return format(
        "; meanwhile %s has come into use, with which it was not compared, so that stays: call "
        "~retrain again, or ~load its file",
        now.c_str());
  publishLive(model);
  return "";
}

/// Says what the model is for, so that no corrector of another arm or tool takes it.
void TrainerNode::identify(Correction& model) const {
  if (!params_.arm.empty() && !model.arm.empty() && model.arm != params_.arm)
    throw InvalidInput(
        format("the recording is of the arm \"%s\", this trainer is for \"%s\" (~arm)",
               model.arm.c_str(), params_.arm.c_str()));
  if (!params_.arm.empty()) model.arm = params_.arm;
  model.tool = params_.tool;
  model.pose_type = params_.pose_type;
  if (params_.valid_hours > 0.0) model.expires_at = model.trained_at + 3600.0 * params_.valid_hours;
}

void TrainerNode::publishReport(const ValidatedTraining& result,
                                const Retrain::Response& response) {
  TrainingReport report;
  report.header.stamp = ros::Time::now();
  report.header.frame_id = result.training.model.frame;
  report.success = response.success;
  report.message = response.message;
  report.model = response.model;
  report.live = response.live;
  report.files = response.files;
  report.delay = response.delay;
  report.pairs_total = response.pairs_total;
  report.pairs_kept = response.pairs_kept;
  report.findings = response.findings;
  const FateCounts& fates = result.training.fates;
  for (std::size_t i = 1; i < fates.count.size(); ++i) {
    if (fates.count[i] == 0) continue;
    report.rejection_reasons.push_back(fateName(static_cast<Fate>(i)));
    report.rejection_counts.push_back(static_cast<std::uint32_t>(fates.count[i]));
  }
  report.trajectories_used =
      static_cast<std::uint32_t>(result.training.model.training_trajectories);
  report.held_out_pairs = static_cast<std::uint32_t>(result.full.n);
  copyComponents(result.none, report.none_position, report.none_angle);
  copyComponents(result.rigid, report.rigid_position, report.rigid_angle);
  copyComponents(result.full, report.full_position, report.full_angle);
  ErrorSummary live;
  live.mean_abs.setConstant(std::numeric_limits<double>::quiet_NaN());
  copyComponents(result.live.value_or(live), report.live_position, report.live_angle);
  report.seconds = response.seconds;
  report_publisher_.publish(report);
}

/// Checks before trust: what is learnt from a recording with an error in it is not to be used.
/// @throws InvalidInput  there is one, and the request does not ignore it
CheckedInputs TrainerNode::readChecked(const std::vector<std::string>& names, bool ignore_checks,
                                       Retrain::Response& response) {
  CheckedInputs inputs =
      readCheckedInputs(names, loadArms(params_.robot, params_.other_robots, ""),
                        [&](double fraction) { work_.report("reading", kReading * fraction); });
  for (const StreamFinding& finding : inputs.findings) {
    response.findings.push_back(toText(finding));
    ROS_WARN("trainer: %s", response.findings.back().c_str());
  }
  if (!ignore_checks)
    refuseErrors(inputs.dataset.source, inputs.findings,
                 "ignore_checks: true in the call of ~retrain");
  return inputs;
}

void TrainerNode::retrain(const Retrain::Request& request, Retrain::Response& response) {
  work_.report("reading", 0.0);
  TrainingConfig config = configurationFrom(
      request.configuration.empty() ? params_.configuration : expandHome(request.configuration));
  if (!request.simulation.empty())
    config.simulation = std::make_shared<const SimulationConfig>(
        loadSimulationConfig(expandHome(request.simulation)));
  if (!request.dry_run && !request.output.empty())
    checkOutputFile(expandHome(request.output), false);  // now, not after the training
  const std::vector<std::string> names = inputsNamed(request.bags, params_.data_directory);
  const CheckedInputs inputs = readChecked(names, request.ignore_checks, response);
  const Dataset& dataset = inputs.dataset;
  Correction before;
  bool has_before = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    has_before = !live_.empty();
    if (has_before) before = live_.back();
  }
  const double now = static_cast<double>(ros::WallTime::now().sec);
  const ValidatedTraining result =
      trainAndValidate(dataset, config, has_before ? &before : nullptr, now,
                       [&](const std::string& phase, double fraction) {
                         work_.report(phase, kReading + (kTrained - kReading) * fraction);
                       });
  Correction model = result.training.model;
  model.inputs.clear();
  for (const std::string& name : names) model.inputs.push_back(fs::absolute(name).string());
  identify(model);
  model.homed_at = inputs.homed_at;
  response.model = model.id;
  response.delay = model.delay;
  response.pairs_total = static_cast<std::uint32_t>(result.training.fates.total());
  response.pairs_kept = static_cast<std::uint32_t>(result.training.fates[Fate::kKept]);
  response.position_before_mm = 1e3 * result.none.position_norm;
  response.position_after_mm = 1e3 * result.full.position_norm;
  response.angle_before_deg = kDegree * result.none.angle_norm;
  response.angle_after_deg = kDegree * result.full.angle_norm;
  response.message = result.verdict;
  if (result.training.delay.status == DelayResult::Status::kNotObservable ||
      result.training.delay.status == DelayResult::Status::kAtLimit)
    response.message +=
        format("; delay %.3f s %s", model.delay, delayStatusText(result.training.delay.status));
  if (request.dry_run) {
    response.success = true;
    response.message += "; dry run: nothing written, nothing live";
  } else {
    work_.report("saving", kTrained);
    const std::string file =
        request.output.empty() ? (fs::path(params_.model_directory) / (model.id + ".bag")).string()
                               : expandHome(request.output);
    writeModelFile(model, file, false);
    response.files.push_back(fs::absolute(file).string());
    response.success = true;
    const std::string stays =
        result.better || request.force
            ? goLiveInsteadOf(has_before ? before.id : "", model, request.force)
            : "; not better, so the model in use stays (force: true overrides)";
    response.live = stays.empty();
    response.message += stays;
  }
  response.seconds = work_.seconds();
  samples_publisher_.publish(samplesToMsg(result.training));
  publishReport(result, response);
}

bool TrainerNode::onRetrain(Retrain::Request& request, Retrain::Response& response) {
  bool ran = false;
  const LongWork::Result result = work_.run([&] {
    ran = true;
    retrain(request, response);
    return response.message;
  });
  response.success = result.success;
  response.message = result.message;
  if (!ran) return true;
  if (!result.success) {
    TrainingReport report;
    report.header.stamp = ros::Time::now();
    report.message = result.message;
    report.findings = response.findings;
    report_publisher_.publish(report);
  }
  ROS_INFO("trainer: %s", response.message.c_str());
  return true;
}

bool TrainerNode::onRollback(std_srvs::Trigger::Request& /*request*/,
                             std_srvs::Trigger::Response& response) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (live_.size() < 2) {
    response.message = "there is no model before the one in use";
    return true;
  }
  live_.pop_back();
  model_publisher_.publish(modelToMsg(live_.back()));
  response.success = true;
  response.message = "model " + live_.back().id + " is live again";
  ROS_INFO("trainer: %s", response.message.c_str());
  return true;
}

bool TrainerNode::onLoad(LoadModel::Request& request, LoadModel::Response& response) {
  try {
    const Correction model = readModelFile(expandHome(request.file));
    Predictor check(model);  // refuses what does not fit together
    goLive(model);
    response.success = true;
    response.message = "model " + model.id + " is live";
    response.model = model.id;
  } catch (const InvalidInput& error) {
    response.message = error.what();
  }
  return true;
}

bool TrainerNode::onSave(SaveModel::Request& request, SaveModel::Response& response) {
  Correction model;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (live_.empty()) {
      response.message = "there is no live model to save; call ~retrain first";
      return true;
    }
    model = live_.back();
  }
  try {
    const std::string file =
        request.file.empty() ? (fs::path(params_.model_directory) / (model.id + ".bag")).string()
                             : expandHome(request.file);
    writeModelFile(model, file, request.overwrite);
    response.success = true;
    response.file = fs::absolute(file).string();
    response.message = "model " + model.id + " written";
  } catch (const InvalidInput& error) {
    response.message = error.what();
  }
  return true;
}

}  // namespace raven_correction
