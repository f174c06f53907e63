// SPDX-License-Identifier: BSD-3-Clause
#include "debridement_learning.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "debridement_places.h"
#include "raven_correction/Retrain.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/robot/inverse_kinematics.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/offline.h"

namespace raven_correction {
namespace {

constexpr double kOnce = 1e9;  // interval of measurements, of which the first counts [s]
constexpr std::uint64_t kRehearsals = 5000, kTrials = 9000;  // seeds
constexpr unsigned kTrialPlaces = 12;
constexpr double kUsualShare = 0.75;  // of the places are not worth replanning
constexpr double kWider = 0.010;      // than the field is what is rehearsed [m]
constexpr double kTurnedMore = 0.1;   // than the task will turn the tool [rad]
constexpr double kFieldSize = 0.080;  // [m]
constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
constexpr double kOverField = 0.030;  // where the deviation is measured first [m]

/// What an arm meets at places like those of the task: it moves as it is told, and at each the
/// deviation of the tool and the predicted one are kept.
class Trial : public DebridementCell {
 public:
  explicit Trial(DebridementArm& arm) : arm_(arm) {}
  double now() override { return arm_.now(); }
  void move(const char* kind, const Pose& X_base_tool, double dwell) override {
    arm_.move(kind, X_base_tool, dwell);
    if (std::string(kind) != "grasp") return;
    if (const std::optional<Eigen::Vector3d> off = arm_.deviation()) deviations.push_back(*off);
    predicted.push_back(arm_.predictedDeviation());
  }
  void setJaw(double opening, double dwell) override { arm_.setJaw(opening, dwell); }
  FieldPicture look() override { return arm_.look(); }
  void wait(double duration) override { arm_.wait(duration); }
  double predictedDeviation() override { return arm_.predictedDeviation(); }
  bool replanHere() override { return arm_.replanHere(); }

  std::vector<Eigen::Vector3d> deviations;  // [m], base frame
  std::vector<double> predicted;            // one standard deviation [m]

 private:
  DebridementArm& arm_;
};

class Learner {
 public:
  Learner(const LearningPlan& plan, DebridementArm& arm, PrivateLaunch& launch,
          const std::function<void(const std::function<void()>&)>& alone, const Progress& tell)
      : plan_(plan), arm_(arm), launch_(launch), alone_(alone), tell_(tell) {}

  DebridementLearning run() {
    begin(0.0, 0.25);
    setCorrectorMode(plan_.arm, "off", launch_);
    // Measured once over the field, the deviation is undone all the while: else the tool would
    // learn of places as far from there as it errs.
    ArmMotion motion;
    motion.replan_interval = kOnce;
    arm_.use(motion);
    RehearsalConfig rehearsal = placesOfTask();
    alone_([&] {
      const DebridementTaskConfig task = taskOf(plan_.arm, plan_.arms);
      const Eigen::Vector3d over = rehearsal.centre + Eigen::Vector3d(0.0, 0.0, kOverField);
      arm_.move("move_to_field", {task.X_base_field * over, task.X_base_rest.q}, 0.0);
      arm_.measureAtRest();
    });
    rehearsal.fragments = std::max(5u, plan_.rehearsals / 2);
    rehearsal.seed = kRehearsals + 10 * plan_.seed + plan_.arm;
    rehearsal.half_size += Eigen::Vector3d(0.015, 0.015, 0.010);  // as much as it may be off
    rehearsal.turn += 0.3;
    learnFrom("rehearsal.bag", rehearsal);

    begin(0.3, 0.6);
    setCorrectorMode(plan_.arm, "full", launch_);
    rehearsal = placesOfTask();
    rehearsal.fragments = plan_.rehearsals;
    rehearsal.seed = kRehearsals + 10 * plan_.seed + plan_.arm + 5;
    const Retrain::Response learnt = learnFrom("rehearsal_corrected.bag", rehearsal);

    begin(0.95, 0.05);
    DebridementLearning learning = tryOut();
    learning.arm = place().name;
    learning.model = learnt.model;
    learning.places = rehearsal.fragments;
    learning.pairs = learnt.pairs_kept;
    learning.before_mm = learnt.position_before_mm;
    learning.after_mm = learnt.position_after_mm;
    learning.before_deg = learnt.angle_before_deg;
    learning.after_deg = learnt.angle_after_deg;
    return learning;
  }

 private:
  const ArmPlace& place() const { return placeOf(plan_.arm); }
  std::string nameOf(const char* node) const { return std::string(place().ns) + node; }
  void begin(double from, double share) {
    from_ = from;
    share_ = share;
  }
  void tell(const char* what, double fraction) {
    if (tell_) tell_(format("%s arm: %s", place().name, what), from_ + share_ * fraction);
  }

  /// Its part of the field, and somewhat more.
  RehearsalConfig placesOfTask() const {
    RehearsalConfig rehearsal;
    const double half = 0.5 * kFieldSize;
    rehearsal.half_size = {half + kWider, half + kWider, 0.020};
    if (plan_.arms > 1) {
      rehearsal.half_size.x() = 0.5 * half + kWider;
      rehearsal.centre.x() = place().lower < 0.0 ? -0.5 * half : 0.5 * half;
    }
    rehearsal.turn = taskOf(plan_.arm, plan_.arms).turn_limit + kTurnedMore;
    return rehearsal;
  }

  void rehearseWith(const RehearsalConfig& rehearsal, DebridementCell& cell, const char* what,
                    double until) {
    const KinematicChain robot = loadKinematicChain(packageFile(place().robot));
    const InverseKinematics ik(robot);
    const auto reachable = [&](const Pose& X) {
      return ik.solve(X, robot.home()).status == IkStatus::kOk;
    };
    alone_([&] {
      rehearse(taskOf(plan_.arm, plan_.arms), rehearsal, reachable, cell,
               [&](unsigned done) { tell(what, until * done / rehearsal.fragments); });
      arm_.move("park", taskOf(plan_.arm, plan_.arms).X_base_rest, 0.0);
    });
  }

  Retrain::Response learnFrom(const char* bag, const RehearsalConfig& rehearsal) {
    StartRecording::Request start;
    start.bag = bag;
    callNode<StartRecording>(launch_, nameOf("/recorder/start"), start);
    rehearseWith(rehearsal, arm_, "motions to learn from", 0.8);
    const StopRecording::Response stop =
        callNode<StopRecording>(launch_, nameOf("/recorder/stop"), {});
    tell("training", 0.8);
    // What was undone for the rehearsal is for the correction to undo from now on.
    alone_([&] { arm_.takeBack(); });
    ArmMotion corrected;
    corrected.replan.corrected = true;
    arm_.use(corrected);
    Retrain::Request request;
    request.bags = stop.bags;
    request.force = true;  // what it knew before was learnt elsewhere
    const Retrain::Response learnt =
        callNode<Retrain>(launch_, nameOf("/trainer/retrain"), request);
    if (!learnt.live)
      throw std::runtime_error("the trained model did not go live: " + learnt.message);
    waitForModel(nameOf("/corrector"), learnt.model, launch_);
    return learnt;
  }

  DebridementLearning tryOut() {
    RehearsalConfig places = placesOfTask();
    places.fragments = kTrialPlaces;
    places.seed = kTrials + 10 * plan_.seed + plan_.arm;
    places.half_size -= Eigen::Vector3d(kWider, kWider, 0.014);
    places.centre.z() = 0.008;
    places.turn -= kTurnedMore;
    places.tilt = 0.0;
    places.dwell = 0.6;
    Trial trial(arm_);
    rehearseWith(places, trial, "trial", 1.0);
    DebridementLearning learning;
    learning.trial_places = static_cast<unsigned>(trial.deviations.size());
    std::vector<double> lengths, components[3], known;
    for (const Eigen::Vector3d& off : trial.deviations) {
      lengths.push_back(off.norm());
      for (int k = 0; k < 3; ++k) components[k].push_back(off(k));
    }
    // Medians: motion capture is wrong at times, and far then.
    for (int k = 0; k < 3; ++k)
      learning.trial_median(k) = lengths.empty() ? kNotKnown : median(components[k]);
    learning.trial_deviation = lengths.empty() ? kNotKnown : median(lengths);
    for (const double predicted : trial.predicted)
      if (std::isfinite(predicted)) known.push_back(predicted);
    learning.usual_prediction =
        known.empty() ? std::numeric_limits<double>::infinity() : quantile(known, kUsualShare);
    return learning;
  }

  const LearningPlan& plan_;
  DebridementArm& arm_;
  PrivateLaunch& launch_;
  const std::function<void(const std::function<void()>&)>& alone_;
  const Progress& tell_;
  double from_ = 0.0, share_ = 1.0;
};

}  // namespace

void setCorrectorMode(unsigned arm, const std::string& mode, PrivateLaunch& launch) {
  SetMode::Request request;
  request.mode = mode;
  callNode<SetMode>(launch, std::string(placeOf(arm).ns) + "/corrector/set_mode", request);
}

DebridementLearning learnDebridement(const LearningPlan& plan, DebridementArm& arm,
                                     PrivateLaunch& launch,
                                     const std::function<void(const std::function<void()>&)>& alone,
                                     const Progress& tell) {
  return Learner(plan, arm, launch, alone, tell).run();
}

}  // namespace raven_correction
