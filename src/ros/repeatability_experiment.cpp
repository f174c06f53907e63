// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/repeatability_experiment.h"

#include <ros/console.h>
#include <ros/ros.h>

#include <filesystem>
#include <mutex>

#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/Retrain.h"
#include "raven_correction/RunPlanner.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "raven_correction/WorkProgress.h"
#include "raven_correction/correction/corrector.h"
#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/planner_node.h"
#include "raven_correction/ros/private_launch.h"
#include "raven_correction/ros/session_visits.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr char kArm[] = "raven/left";
constexpr double kRest = 0.3;  // before the end of a visit, in which the tool is at rest [s]
constexpr double kClockTimeout = 10.0;  // for the first message on /clock [s, real]
// Motions, orders and noise are drawn independently of one another.
constexpr std::uint32_t kPosesSeed = 1000, kTrainingSeed = 2000, kOrderSeed = 3000;

/// What the nodes say while they work.
class Ear {
 public:
  Ear(ros::NodeHandle& nh, const Progress& progress) : progress_(progress), spinner_(1) {
    for (const char* node : {"planner", "trainer"})
      subscribers_.push_back(nh.subscribe<WorkProgress>(
          std::string(node) + "/progress", 100,
          [this](const WorkProgressConstPtr& message) { onProgress(*message); }));
    subscribers_.push_back(nh.subscribe<CorrectionStatus>(
        topics::kStatus, 10000, [this](const CorrectionStatusConstPtr& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          ++codes_[correctorCodeName(static_cast<CorrectorCode>(message->code))];
        }));
    spinner_.start();
  }
  ~Ear() { spinner_.stop(); }

  /// Progress of what is asked next counts from `from` to `to` of the whole.
  void begin(const std::string& phase, double from, double to) {
    const std::lock_guard<std::mutex> lock(mutex_);
    phase_ = phase;
    from_ = from;
    to_ = to;
    codes_.clear();
    if (progress_) progress_(phase, from);
  }
  std::map<std::string, std::uint64_t> codes() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return codes_;
  }
  const SimulatorCycles& cycles() const noexcept { return cycles_; }

 private:
  void onProgress(const WorkProgress& message) {
    if (message.state != WorkProgress::RUNNING) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (progress_ && !phase_.empty()) progress_(phase_, from_ + message.fraction * (to_ - from_));
  }

  const Progress& progress_;
  std::mutex mutex_;  // guards what follows
  std::string phase_;
  double from_ = 0.0, to_ = 0.0;
  std::map<std::string, std::uint64_t> codes_;
  // Last: callbacks use all of the above.
  SimulatorCycles cycles_;
  std::vector<ros::Subscriber> subscribers_;
  ros::AsyncSpinner spinner_;
};

class Experiment {
 public:
  Experiment(const RepeatabilityParams& params, PrivateLaunch& launch, const Progress& progress)
      : params_(params), launch_(launch), nh_(kArm), ear_(nh_, progress) {
    std::vector<std::string> services;
    for (const char* service : {"recorder/start", "recorder/stop", "planner/run", "trainer/retrain",
                                "corrector/set_mode"})
      services.push_back(nh_.resolveName(service));
    launch_.waitForServices(services);
    if (!ros::Time::waitForValid(ros::WallDuration(kClockTimeout)))
      throw std::runtime_error("the simulator does not publish /clock");
    drawVisits();
  }

  RepeatabilityReport run() {
    const double visiting = params_.poses * params_.visits, learning = params_.trajectories;
    const double all = 3.0 * visiting + 1.1 * learning;  // the training takes a tenth of the time
    double done = 0.0;
    const auto phase = [&](const char* name, double work) {
      ear_.begin(name, done / all, (done + work) / all);
      done += work;
    };
    const ros::Time simulated_begin = ros::Time::now();
    const ros::SteadyTime begin = ros::SteadyTime::now();
    RepeatabilityReport report;
    report.poses = params_.poses;
    report.visits = params_.visits;
    report.seed = params_.seed;

    phase("visits without correction", visiting);
    report.conditions.push_back(visit("none"));
    phase("motions to learn from", learning);
    const std::string session = recordTraining(report);
    phase("training", 0.1 * learning);
    retrain(session, report);
    phase("visits, full trajectory corrected", visiting);
    setMode("full");
    report.conditions.push_back(visit("full"));
    phase("visits, endpoints corrected", visiting);
    setMode("endpoint");
    report.conditions.push_back(visit("endpoint"));
    ear_.begin("done", 1.0, 1.0);

    report.clock_rate =
        (ros::Time::now() - simulated_begin).toSec() / (ros::SteadyTime::now() - begin).toSec();
    report.cycles = ear_.cycles().total();
    report.late_cycles = ear_.cycles().late();
    return report;
  }

 private:
  /// Poses over the field of the planner that runs, and the order in which they are visited.
  void drawVisits() {
    const PlannerParams planner = loadPlannerParams(ros::NodeHandle(nh_, "planner"));
    DebridementMotion motion(planner.motion, loadKinematicChain(planner.robot),
                             kPosesSeed + params_.seed);
    std::vector<Pose> poses;
    for (unsigned i = 0; i < params_.poses; ++i) poses.push_back(motion.randomTarget());
    order_ = visitOrder(params_.poses, params_.visits, kOrderSeed + params_.seed);
    for (const std::size_t i : order_) targets_.push_back(poseToMsg(poses[i]));
  }

  template <typename Service>
  typename Service::Response call(const std::string& name,
                                  const typename Service::Request& request) {
    return callNode<Service>(launch_, nh_.resolveName(name), request);
  }

  /// The planner's motions in one bag.
  std::string record(const std::string& name, const RunPlanner::Request& motions) {
    StartRecording::Request start;
    start.bag = name + ".bag";
    call<StartRecording>("recorder/start", start);
    call<RunPlanner>("planner/run", motions);
    const StopRecording::Response stop = call<StopRecording>("recorder/stop", {});
    if (stop.bags.size() != 1)
      throw std::runtime_error(
          format("%s: the recorder wrote %zu bags, one was expected; split_size_mb and "
                 "split_duration must be 0",
                 name.c_str(), stop.bags.size()));
    return stop.bags.front();
  }

  RepeatabilityCondition visit(const std::string& name) {
    RunPlanner::Request motions;
    motions.targets = targets_;
    motions.prefix = "visit";
    const std::string bag = record(name, motions);
    RepeatabilityCondition condition;
    condition.name = name;
    condition.codes = ear_.codes();
    const std::vector<Visit> visits = readVisits(bag, kRest);
    if (visits.size() != order_.size())
      throw std::runtime_error(
          format("%s holds %zu visits, expected %zu", bag.c_str(), visits.size(), order_.size()));
    condition.result = repeatability(visits, order_);  // sorted by start: in the order of the calls
    return condition;
  }

  std::string recordTraining(RepeatabilityReport& report) {
    RunPlanner::Request motions;
    motions.trajectories = params_.trajectories;
    motions.seed = kTrainingSeed + params_.seed;
    motions.turn = params_.turn;
    motions.margin = params_.margin;
    report.training_trajectories = params_.trajectories;
    return record("training", motions);
  }

  void retrain(const std::string& session, RepeatabilityReport& report) {
    Retrain::Request request;
    request.bags = {session};
    const Retrain::Response learnt = call<Retrain>("trainer/retrain", request);
    if (!learnt.live)
      throw std::runtime_error("the trained model did not go live: " + learnt.message);
    waitForModel(nh_.resolveName("corrector"), learnt.model, launch_);
    report.model = learnt.model;
    report.training_pairs = learnt.pairs_kept;
  }

  void setMode(const std::string& name) {
    SetMode::Request mode;
    mode.mode = name;
    call<SetMode>("corrector/set_mode",
                  mode);  // which enables it, too; ~enable has a mode of its own
  }

  const RepeatabilityParams& params_;
  PrivateLaunch& launch_;
  ros::NodeHandle nh_;
  Ear ear_;
  std::vector<std::size_t> order_;
  std::vector<geometry_msgs::Pose> targets_;  // one per visit
};

}  // namespace

void checkRepeatability(const RepeatabilityParams& params) {
  if (params.poses == 0 || params.visits == 0)
    throw InvalidInput("poses and visits must be at least 1; the paper has 10 and 10");
  if (params.trajectories < 3)
    throw InvalidInput(
        format("%u trajectories to learn from, at least 3 are needed", params.trajectories));
  if (!(params.clock_rate > 0.0 && params.clock_rate <= 20.0))
    throw InvalidInput(
        format("clock rate = %g is outside (0, 20] simulated s per s", params.clock_rate));
  for (const std::string& file : {params.simulation, params.configuration})
    if (!file.empty() && !std::filesystem::exists(file))
      throw InvalidInput(format("%s: no such file", file.c_str()));
}

RepeatabilityReport runRepeatability(const RepeatabilityParams& params, const Progress& progress) {
  checkRepeatability(params);
  const std::string folder = std::filesystem::absolute(params.folder);
  std::vector<std::string> arguments{"raven_correction",
                                     "demo.launch",
                                     std::string("arm:=") + kArm,
                                     format("seed:=%u", params.seed),
                                     format("clock_rate:=%g", params.clock_rate),
                                     "record_directory:=" + folder,
                                     "model_directory:=" + folder,
                                     "overlay:=false",
                                     "required:=true"};
  if (!params.simulation.empty())
    arguments.push_back("simulation:=" + std::filesystem::absolute(params.simulation).string());
  if (!params.configuration.empty())
    arguments.push_back("trainer_configuration:=" +
                        std::filesystem::absolute(params.configuration).string());
  if (!params.play) arguments.emplace_back("play_robot:=");
  if (progress) progress("starting the nodes", 0.0);
  PrivateLaunch launch(arguments, folder, "repeatability");
  // Standard output is for the table.
  if (ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Warn))
    ros::console::notifyLoggerLevelsChanged();
  return Experiment(params, launch, progress).run();
}

}  // namespace raven_correction
