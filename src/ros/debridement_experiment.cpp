// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/debridement_experiment.h"

#include <ros/console.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "debridement_learning.h"
#include "debridement_places.h"
#include "debridement_witness.h"
#include "raven_correction/LoadScene.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/debridement_arm.h"
#include "raven_correction/ros/field_eye.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/private_launch.h"

namespace raven_correction {
namespace {

constexpr char kCamera[] = "/field_camera/simulator";
constexpr char kSimulator[] = "/raven/simulator";
constexpr double kClockTimeout = 10.0;   // for the first message on /clock [s, real]
constexpr double kOnItsWay = 0.5;        // of a message, long [s, real]
constexpr double kLearning = 0.3;        // of all the work, roughly [-]
constexpr std::uint64_t kScenes = 1000;  // seeds

/// How an arm works in a condition.
struct Manner {
  const char* name;
  const char* mode;  // of the corrector
  double speed;
  double replan_interval;
  double settle;  // at a fragment: a replanning planner waits for what its last measurement does
  bool by_deviation;
};
const Manner kManners[] = {{"baseline", "off", 0.01, 1.0, 1.5, false},
                           {"corrected", "full", 0.06, 0.0, 0.25, false},
                           {"corrected_replanning", "full", 0.06, 0.0, 0.25, true}};

std::vector<std::string> namespacesOf(unsigned arms) {
  std::vector<std::string> all;
  for (unsigned i = 0; i < arms; ++i) all.emplace_back(placeOf(i).ns);
  return all;
}

class Experiment {
 public:
  Experiment(const DebridementParams& params, PrivateLaunch& launch, const Progress& progress)
      : params_(params),
        launch_(launch),
        progress_(progress),
        spinner_(3),
        eye_("/field_camera", kSimulator),
        witness_(namespacesOf(params.arms), kCamera, kSimulator, params.folder + "/grasps.csv") {
    spinner_.start();
    std::vector<std::string> services{std::string(kCamera) + "/load_scene",
                                      std::string(kCamera) + "/take_picture",
                                      std::string(kSimulator) + "/pause"};
    for (unsigned i = 0; i < params.arms; ++i)
      for (const char* service :
           {"/recorder/start", "/recorder/stop", "/trainer/retrain", "/corrector/set_mode"})
        services.push_back(std::string(placeOf(i).ns) + service);
    launch_.waitForServices(services);
    if (!ros::Time::waitForValid(ros::WallDuration(kClockTimeout)))
      throw std::runtime_error("the simulator does not publish /clock");
    for (unsigned i = 0; i < params.arms; ++i)
      arms_.push_back(
          std::make_unique<DebridementArm>(placeOf(i).ns, "0_link", eye_, interrupted_));
  }
  ~Experiment() { spinner_.stop(); }

  DebridementReport run() {
    DebridementReport report;
    report.arms = params_.arms;
    report.seed = params_.seed;
    report.attempts = params_.attempts;
    report.look_time = ArmMotion().look_time;
    const ros::Time simulated_begin = ros::Time::now();
    const ros::SteadyTime begin = ros::SteadyTime::now();
    for (unsigned i = 0; i < params_.arms; ++i) report.learning.push_back(learn(i));
    learning_ = report.learning;
    for (const Manner& manner : kManners) {
      if (!isAskedFor(manner.name)) continue;
      report.conditions.push_back(work(manner));
    }
    tell("done", 1.0);
    report.stood = eye_.stood();
    report.clock_rate = (ros::Time::now() - simulated_begin).toSec() /
                        ((ros::SteadyTime::now() - begin).toSec() - report.stood);
    report.cycles = cycles_.total();
    report.late_cycles = cycles_.late();
    return report;
  }

 private:
  bool isAskedFor(const std::string& name) const {
    const std::vector<std::string>& asked = params_.conditions;
    return asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end();
  }
  void tell(const std::string& phase, double fraction) {
    if (progress_) progress_(phase, fraction);
  }
  /// Works in a thread per arm, while this one looks after the nodes.
  /// @throws what was thrown first
  void together(const std::function<void(unsigned)>& job) {
    std::vector<std::thread> threads;
    std::mutex mutex;
    std::exception_ptr first;
    const auto fail = [&] {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!first) first = std::current_exception();
      interrupted_ = true;  // the other arm has nobody to share the field with
    };
    std::atomic<unsigned> running{params_.arms};
    for (unsigned i = 0; i < params_.arms; ++i)
      threads.emplace_back([&, i] {
        try {
          job(i);
        } catch (...) {
          fail();
        }
        --running;
      });
    while (running > 0) {
      ros::WallDuration(0.05).sleep();
      try {
        if (!interrupted_) launch_.requireAlive();
      } catch (...) {
        fail();
      }
    }
    for (std::thread& thread : threads) thread.join();
    if (first) std::rethrow_exception(first);
  }

  DebridementLearning learn(unsigned arm) {
    LearningPlan plan;
    plan.arm = arm;
    plan.arms = params_.arms;
    plan.rehearsals = params_.rehearsals;
    plan.seed = params_.seed;
    const auto alone = [&](const std::function<void()>& job) {
      together([&](unsigned i) {
        if (i == arm) job();  // the other one stays at home
      });
    };
    return learnDebridement(plan, *arms_[arm], launch_, alone,
                            [&](const std::string& phase, double fraction) {
                              tell(phase, kLearning * (arm + fraction) / params_.arms);
                            });
  }

  DebridementCondition work(const Manner& manner) {
    ArmMotion motion;
    motion.speed = manner.speed;
    motion.replan_interval = manner.replan_interval;
    motion.replan.corrected = std::string(manner.mode) != "off";
    // What the last condition undid would be undone twice.
    together([&](unsigned i) { arms_[i]->takeBack(); });
    for (unsigned i = 0; i < params_.arms; ++i) setCorrectorMode(i, manner.mode, launch_);
    together([&](unsigned i) {
      arms_[i]->use(motion);
      if (manner.replan_interval > 0.0) arms_[i]->measureAtRest();
      arms_[i]->move("move_to_start", taskOf(i, params_.arms).X_base_rest, 0.0);
    });
    DebridementCondition condition;
    condition.name = manner.name;
    condition.speed = manner.speed;
    condition.replan_interval = manner.replan_interval;
    if (manner.by_deviation)
      condition.deviation_limit = params_.deviation_limit > 0.0 ? params_.deviation_limit : -1.0;
    witness_.begin(condition.name);
    unsigned fragments = 0;
    for (std::uint64_t k = 0; fragments < params_.fragments; ++k) {
      tell(condition.name,
           kLearning +
               (1.0 - kLearning) *
                   (&manner - kManners + static_cast<double>(fragments) / params_.fragments) / 3.0);
      condition.fields.push_back(clear(manner, condition, kScenes * params_.seed + k));
      fragments += condition.fields.back().fragments;
    }
    condition.clearance = witness_.clearance();
    condition.poses = witness_.poses();
    return condition;
  }

  ClearedField clear(const Manner& manner, const DebridementCondition& condition,
                     std::uint64_t seed) {
    LoadScene::Request request;
    request.seed = seed;
    ClearedField field;
    field.seed = seed;
    field.fragments =
        callNode<LoadScene>(launch_, std::string(kCamera) + "/load_scene", request).fragments;
    witness_.begin(seed);
    FragmentBookConfig rules;
    rules.attempts = params_.attempts;
    std::vector<FieldPart> parts;
    for (unsigned i = 0; i < params_.arms; ++i) {
      FieldPart part;
      if (params_.arms > 1) {
        part.lower = placeOf(i).lower;
        part.upper = placeOf(i).upper;
      }
      part.p_field_home = placeOf(i).p_base_receptacle - fieldOf(params_.arms).p;
      parts.push_back(part);
    }
    FragmentBook book(rules, parts);
    std::mutex mutex;
    const double begin = ros::Time::now().toSec();
    double end = begin;
    together([&](unsigned i) {
      DebridementTaskConfig config = taskOf(i, params_.arms);
      config.settle = manner.settle;
      config.deviation_limit = condition.deviation_limit < 0.0 ? learning_[i].usual_prediction
                                                               : condition.deviation_limit;
      DebridementTask task(config, i, *arms_[i], book);
      const std::vector<FragmentRecord> records = task.run();
      const std::lock_guard<std::mutex> lock(mutex);
      field.records.insert(field.records.end(), records.begin(), records.end());
      field.waited += task.waited();
      end = std::max(end, arms_[i]->now());
    });
    field.seconds = end - begin;
    // The camera answers after it has judged the last jaws; what it says of them is on its way
    // then.
    callNode<std_srvs::Trigger>(launch_, std::string(kCamera) + "/take_picture", {});
    ros::WallDuration(kOnItsWay).sleep();
    field.held = witness_.count(GraspResult::HELD);
    field.missed = witness_.count(GraspResult::MISSED);
    field.delivered = witness_.count(GraspResult::DELIVERED);
    field.dropped = witness_.count(GraspResult::DROPPED) + witness_.count(GraspResult::LOST);
    return field;
  }

  const DebridementParams& params_;
  PrivateLaunch& launch_;
  const Progress& progress_;
  std::atomic<bool> interrupted_{false};
  ros::AsyncSpinner spinner_;
  FieldEye eye_;
  DebridementWitness witness_;
  SimulatorCycles cycles_;
  std::vector<DebridementLearning> learning_;  // by arm
  std::vector<std::unique_ptr<DebridementArm>> arms_;
};

}  // namespace

void checkDebridement(const DebridementParams& params) {
  if (params.fragments == 0) throw InvalidInput("fragments = 0, must be at least 1; default 60");
  if (params.arms != 1 && params.arms != 2)
    throw InvalidInput(format("arms = %u, must be 1 or 2", params.arms));
  if (params.rehearsals < 5)
    throw InvalidInput(format("%u places to learn from, at least 5 are needed", params.rehearsals));
  if (params.attempts == 0) throw InvalidInput("attempts = 0, must be at least 1");
  if (!(params.clock_rate > 0.0 && params.clock_rate <= 20.0))
    throw InvalidInput(
        format("clock rate = %g is outside (0, 20] simulated s per s", params.clock_rate));
  if (!(params.deviation_limit >= 0.0 && params.deviation_limit <= 0.1))
    throw InvalidInput(
        format("deviation limit = %g m is outside [0, 0.1]", params.deviation_limit));
  for (const std::string& name : params.conditions)
    if (std::none_of(std::begin(kManners), std::end(kManners),
                     [&](const Manner& manner) { return name == manner.name; }))
      throw InvalidInput(
          format("%s is no condition; these are: baseline, corrected, corrected_replanning",
                 name.c_str()));
  if (!params.configuration.empty() && !std::filesystem::exists(params.configuration))
    throw InvalidInput(format("%s: no such file", params.configuration.c_str()));
}

DebridementReport runDebridement(const DebridementParams& params, const Progress& progress) {
  checkDebridement(params);
  const std::string folder = std::filesystem::absolute(params.folder);
  std::vector<std::string> arguments{"raven_correction",
                                     "debridement.launch",
                                     format("seed:=%u", params.seed),
                                     format("clock_rate:=%g", params.clock_rate),
                                     "record_directory:=" + folder,
                                     "model_directory:=" + folder,
                                     "required:=true"};
  const Eigen::Vector3d field = fieldOf(params.arms).p;
  arguments.push_back(format("field_position:=[%g, %g, %g]", field.x(), field.y(), field.z()));
  if (params.arms == 1) {
    const Eigen::Vector3d& p = placeOf(0).p_base_receptacle;
    arguments.emplace_back("two_arms:=false");
    arguments.push_back(format("grippers:=[%s]", placeOf(0).ns));
    arguments.push_back(format("receptacles:=[%g, %g, %g]", p.x(), p.y(), p.z()));
  }
  if (!params.configuration.empty())
    arguments.push_back("trainer_configuration:=" +
                        std::filesystem::absolute(params.configuration).string());
  if (progress) progress("starting the nodes", 0.0);
  PrivateLaunch launch(arguments, folder, "debridement");
  // Standard output is for the table.
  if (ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Warn))
    ros::console::notifyLoggerLevelsChanged();
  return Experiment(params, launch, progress).run();
}

}  // namespace raven_correction
