// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/debridement_experiment.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/console.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>
#include <tuple>

#include "raven_correction/GraspResult.h"
#include "raven_correction/LoadScene.h"
#include "raven_correction/Retrain.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/robot/inverse_kinematics.h"
#include "raven_correction/ros/debridement_arm.h"
#include "raven_correction/ros/field_eye.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/private_launch.h"

namespace raven_correction {
namespace {

constexpr char kCamera[] = "/field_camera";
constexpr char kSimulator[] = "/raven/simulator";
constexpr double kClockTimeout = 10.0;  // for the first message on /clock [s, real]
constexpr double kOnItsWay = 0.2;       // of a message, long [s, real]
constexpr double kPlatform = -0.170;    // height of its surface in the base frame [m]
constexpr double kOnce = 1e9;           // interval of measurements, of which the first counts [s]
constexpr unsigned kMotionsPerTwoPlaces = 7;                 // of a rehearsal
constexpr std::uint64_t kScenes = 1000, kRehearsals = 5000;  // seeds

struct ArmPlace {
  const char* name;
  const char* robot;
  Eigen::Vector3d p_base_receptacle;
  double lower, upper;  // part of the field that they share, x [m]
};
/// Two arms share a field between them; one alone has a field in front of it.
const ArmPlace kPlaces[] = {
    {"/raven/left", "config/robots/raven2_left.yaml", {-0.020, -0.0203, -0.105}, 0.0, 1.0},
    {"/raven/right", "config/robots/raven2_right.yaml", {-0.1286, -0.0203, -0.105}, -1.0, 0.0}};

Pose fieldOf(unsigned arms) {
  return {{arms == 1 ? -0.020 : -0.0743, -0.058, kPlatform}, Eigen::Quaterniond::Identity()};
}

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

/// What the nodes say of the truth while the arms work.
class Witness {
 public:
  explicit Witness(const std::string& folder) : table_(folder + "/grasps.csv") {
    table_ << "condition,scene,stamp,gripper,outcome,fragment,along_mm,across_mm,pads_mm,extent_mm,"
              "tilt_deg\n";
    ros::NodeHandle nh;
    subscribers_.push_back(nh.subscribe<GraspResult>(
        std::string(kCamera) + "/simulator/grasps", 100,
        [this](const GraspResultConstPtr& message) { onGrasp(*message); }));
    subscribers_.push_back(
        nh.subscribe<std_msgs::Float64>(std::string(kSimulator) + "/clearance", 100,
                                        [this](const std_msgs::Float64ConstPtr& message) {
                                          const std::lock_guard<std::mutex> lock(mutex_);
                                          clearance_ = std::min(clearance_, message->data);
                                        }));
    subscribers_.push_back(nh.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100, [this](const diagnostic_msgs::DiagnosticArrayConstPtr& message) {
          onDiagnostics(*message);
        }));
  }
  void begin(const std::string& condition) {
    const std::lock_guard<std::mutex> lock(mutex_);
    condition_ = condition;
    clearance_ = std::numeric_limits<double>::infinity();
  }
  void begin(std::uint64_t scene) {
    const std::lock_guard<std::mutex> lock(mutex_);
    scene_ = scene;
    counts_.fill(0);
  }
  unsigned count(std::uint8_t outcome) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return counts_.at(outcome);
  }
  double clearance() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return clearance_;
  }
  std::pair<std::uint64_t, std::uint64_t> cycles() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return {cycles_, late_cycles_};
  }

 private:
  void onGrasp(const GraspResult& message) {
    static const char* const names[] = {"held", "missed", "delivered", "dropped", "lost", "empty"};
    const std::lock_guard<std::mutex> lock(mutex_);
    if (message.outcome >= counts_.size()) return;
    ++counts_[message.outcome];
    table_ << condition_ << ',' << scene_ << ','
           << format("%.3f,%s,%s,%d,%.2f,%.2f,%.2f,%.2f,%.1f\n", message.header.stamp.toSec(),
                     message.gripper.c_str(), names[message.outcome], message.fragment,
                     1e3 * message.offset.x, 1e3 * message.offset.y, 1e3 * message.offset.z,
                     1e3 * message.extent, message.tilt * 180.0 / M_PI)
           << std::flush;
  }
  void onDiagnostics(const diagnostic_msgs::DiagnosticArray& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const diagnostic_msgs::DiagnosticStatus& status : message.status)
      for (const diagnostic_msgs::KeyValue& value : status.values) {
        if (value.key == "cycles") cycles_ = std::strtoull(value.value.c_str(), nullptr, 10);
        if (value.key == "late cycles")
          late_cycles_ = std::strtoull(value.value.c_str(), nullptr, 10);
      }
  }

  std::mutex mutex_;  // guards what follows
  std::ofstream table_;
  std::string condition_;
  std::uint64_t scene_ = 0;
  std::array<unsigned, 6> counts_{};
  double clearance_ = std::numeric_limits<double>::infinity();
  std::uint64_t cycles_ = 0, late_cycles_ = 0;
  std::vector<ros::Subscriber> subscribers_;
};

class Experiment {
 public:
  Experiment(const DebridementParams& params, PrivateLaunch& launch, const Progress& progress)
      : params_(params),
        launch_(launch),
        progress_(progress),
        spinner_(3),
        eye_(kCamera, kSimulator),
        witness_(params.folder) {
    spinner_.start();
    std::vector<std::string> services{std::string(kCamera) + "/simulator/load_scene",
                                      std::string(kCamera) + "/simulator/take_picture",
                                      std::string(kSimulator) + "/pause"};
    for (unsigned i = 0; i < params.arms; ++i)
      for (const char* service :
           {"/recorder/start", "/recorder/stop", "/trainer/retrain", "/corrector/set_mode"})
        services.push_back(std::string(kPlaces[i].name) + service);
    launch_.waitForServices(services);
    if (!ros::Time::waitForValid(ros::WallDuration(kClockTimeout)))
      throw std::runtime_error("the simulator does not publish /clock");
    for (unsigned i = 0; i < params.arms; ++i)
      arms_.push_back(
          std::make_unique<DebridementArm>(kPlaces[i].name, "0_link", eye_, interrupted_));
  }
  ~Experiment() { spinner_.stop(); }

  DebridementReport run() {
    DebridementReport report;
    report.arms = params_.arms;
    report.seed = params_.seed;
    report.attempts = params_.attempts;
    report.folder = params_.folder;
    report.look_time = ArmMotion().look_time;
    const ros::Time simulated_begin = ros::Time::now();
    const ros::SteadyTime begin = ros::SteadyTime::now();
    for (unsigned i = 0; i < params_.arms; ++i) report.learning.push_back(learn(i));
    for (const Manner& manner : kManners) {
      if (!isAskedFor(manner.name)) continue;
      report.conditions.push_back(work(manner));
    }
    tell("done", 1.0);
    report.stood = eye_.stood();
    report.clock_rate = (ros::Time::now() - simulated_begin).toSec() /
                        ((ros::SteadyTime::now() - begin).toSec() - report.stood);
    std::tie(report.cycles, report.late_cycles) = witness_.cycles();
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
  /// @throws std::runtime_error  the node is gone, or it says that it did not succeed
  template <typename Service>
  typename Service::Response call(const std::string& name,
                                  const typename Service::Request& request) {
    typename Service::Response response;
    const bool answered = ros::service::call(name, request, response);
    launch_.requireAlive();
    if (!answered) throw std::runtime_error(name + " did not answer");
    if (!response.success) throw std::runtime_error(name + ": " + response.message);
    return response;
  }

  DebridementTaskConfig taskOf(unsigned arm) const {
    DebridementTaskConfig task;
    task.X_base_field = fieldOf(params_.arms);
    task.X_base_rest = {kPlaces[arm].p_base_receptacle, task.orientation.normalized()};
    return task;
  }

  /// Works in a thread per arm, while this one looks after the nodes.
  void together(const std::function<void(unsigned)>& job) {
    std::vector<std::thread> threads;
    std::vector<std::exception_ptr> errors(params_.arms);
    std::atomic<unsigned> running{params_.arms};
    for (unsigned i = 0; i < params_.arms; ++i)
      threads.emplace_back([&, i] {
        try {
          job(i);
        } catch (...) {
          errors[i] = std::current_exception();
          interrupted_ = true;  // the other arm has nobody to share the field with
        }
        --running;
      });
    std::exception_ptr failed;
    while (running > 0) {
      ros::WallDuration(0.05).sleep();
      try {
        if (!failed) launch_.requireAlive();
      } catch (...) {
        failed = std::current_exception();
        interrupted_ = true;
      }
    }
    for (std::thread& thread : threads) thread.join();
    if (failed) std::rethrow_exception(failed);
    for (const std::exception_ptr& error : errors)
      if (error) std::rethrow_exception(error);
  }

  /// Records motions to places where nothing lies, without correction, and learns from them.
  DebridementLearning learn(unsigned arm) {
    const std::string ns = kPlaces[arm].name;
    const auto fraction = [&](double share) {
      return (0.3 * (arm + share)) / params_.arms;  // of the whole, roughly
    };
    setMode(arm, "off");
    // Measured once, the deviation at home is undone all the while: else the tool would learn of
    // places as far from the field as it errs.
    ArmMotion motion;
    motion.replan_interval = kOnce;
    arms_[arm]->use(motion);
    arms_[arm]->measureAtRest();
    StartRecording::Request start;
    start.bag = "rehearsal.bag";
    call<StartRecording>(ns + "/recorder/start", start);
    RehearsalConfig rehearsal;
    rehearsal.fragments = params_.rehearsals;
    rehearsal.seed = kRehearsals + 10 * params_.seed + arm;
    if (params_.arms > 1) {  // its own part, and as much as the tool may be off
      rehearsal.half_size.x() = 0.045;
      rehearsal.centre.x() = arm == 0 ? 0.020 : -0.020;
    }
    const KinematicChain robot = loadKinematicChain(packageFile(kPlaces[arm].robot));
    const InverseKinematics ik(robot);
    together([&](unsigned i) {
      if (i != arm) return;  // it stays at home
      rehearse(
          taskOf(arm), rehearsal,
          [&](const Pose& X) { return ik.solve(X, robot.home()).status == IkStatus::kOk; },
          *arms_[arm],
          [&](unsigned done) {
            tell(ns.substr(7) + " arm: motions to learn from",
                 fraction(0.8 * done / rehearsal.fragments));
          });
      arms_[arm]->move("park", taskOf(arm).X_base_rest, 0.0);
    });
    const StopRecording::Response stop = call<StopRecording>(ns + "/recorder/stop", {});
    tell(ns.substr(7) + " arm: training", fraction(0.8));
    Retrain::Request request;
    request.bags = stop.bags;
    const Retrain::Response learnt = call<Retrain>(ns + "/trainer/retrain", request);
    if (!learnt.live)
      throw std::runtime_error("the trained model did not go live: " + learnt.message);
    waitForModel(ns + "/corrector", learnt.model, launch_);
    DebridementLearning learning;
    learning.arm = ns.substr(7);
    learning.model = learnt.model;
    learning.trajectories = kMotionsPerTwoPlaces * params_.rehearsals / 2;
    learning.pairs = learnt.pairs_kept;
    learning.before_mm = learnt.position_before_mm;
    learning.after_mm = learnt.position_after_mm;
    learning.before_deg = learnt.angle_before_deg;
    learning.after_deg = learnt.angle_after_deg;
    return learning;
  }

  void setMode(unsigned arm, const std::string& name) {
    SetMode::Request mode;
    mode.mode = name;
    call<SetMode>(std::string(kPlaces[arm].name) + "/corrector/set_mode", mode);
  }

  DebridementCondition work(const Manner& manner) {
    ArmMotion motion;
    motion.speed = manner.speed;
    motion.replan_interval = manner.replan_interval;
    for (unsigned i = 0; i < params_.arms; ++i) setMode(i, manner.mode);
    together([&](unsigned i) {
      arms_[i]->use(motion);
      if (manner.replan_interval > 0.0) arms_[i]->measureAtRest();
      arms_[i]->move("move_to_start", taskOf(i).X_base_rest, 0.0);
    });
    DebridementCondition condition;
    condition.name = manner.name;
    condition.speed = manner.speed;
    condition.replan_interval = manner.replan_interval;
    condition.deviation_limit = manner.by_deviation ? params_.deviation_limit : 0.0;
    witness_.begin(condition.name);
    unsigned fragments = 0;
    for (std::uint64_t k = 0; fragments < params_.fragments; ++k) {
      tell(condition.name,
           0.3 + 0.7 * (&manner - kManners + static_cast<double>(fragments) / params_.fragments) /
                     3.0);
      condition.fields.push_back(clear(manner, condition, kScenes * params_.seed + k));
      fragments += condition.fields.back().fragments;
    }
    condition.clearance = witness_.clearance();
    return condition;
  }

  ClearedField clear(const Manner& manner, const DebridementCondition& condition,
                     std::uint64_t seed) {
    LoadScene::Request request;
    request.seed = seed;
    ClearedField field;
    field.seed = seed;
    field.fragments =
        call<LoadScene>(std::string(kCamera) + "/simulator/load_scene", request).fragments;
    witness_.begin(seed);
    FragmentBookConfig rules;
    rules.attempts = params_.attempts;
    std::vector<FieldPart> parts;
    for (unsigned i = 0; i < params_.arms; ++i) {
      FieldPart part;
      if (params_.arms > 1) {
        part.lower = kPlaces[i].lower;
        part.upper = kPlaces[i].upper;
      }
      part.p_field_home = kPlaces[i].p_base_receptacle - fieldOf(params_.arms).p;
      parts.push_back(part);
    }
    FragmentBook book(rules, parts);
    std::mutex mutex;
    const double begin = ros::Time::now().toSec();
    double end = begin;
    together([&](unsigned i) {
      DebridementTaskConfig config = taskOf(i);
      config.settle = manner.settle;
      config.deviation_limit = condition.deviation_limit;
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
    call<std_srvs::Trigger>(std::string(kCamera) + "/simulator/take_picture", {});
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
  Witness witness_;
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
  if (!(params.deviation_limit > 0.0 && params.deviation_limit <= 0.1))
    throw InvalidInput(
        format("deviation limit = %g m is outside (0, 0.1]", params.deviation_limit));
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
    const Eigen::Vector3d& p = kPlaces[0].p_base_receptacle;
    arguments.emplace_back("two_arms:=false");
    arguments.push_back(format("grippers:=[%s]", kPlaces[0].name));
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
