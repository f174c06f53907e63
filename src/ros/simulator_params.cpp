// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the node `simulator`: common ones, and those of each arm.
#include <algorithm>
#include <limits>
#include <map>

#include "raven_correction/error.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/simulator_node.h"

namespace raven_correction {
namespace {

constexpr std::size_t kMaxArms = 4;  // as many as the UW software has names for
constexpr int kMaxSeed = std::numeric_limits<int>::max();

/// What is read of an arm, with the registration as it is written.
struct ArmReading {
  SimulatedArmParams params;
  // Where the debridement session of 2014 had its cameras. x y z [m] yaw pitch roll [rad]
  std::vector<double> registration{0.087, 1.778, -0.770, -0.273, -0.050, 1.586};
};

Pose poseFromYawPitchRoll(const std::vector<double>& values) {
  return {{values[0], values[1], values[2]},
          Eigen::AngleAxisd(values[3], Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(values[4], Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(values[5], Eigen::Vector3d::UnitX())};
}

/// @param prefix  of the names of parameters: empty, or "ARM/"
void readArm(ParamReader& read, const std::string& prefix, ArmReading& arm) {
  SimulatedArmParams& params = arm.params;
  read.text(prefix + "simulation", params.simulation);
  read.integer(prefix + "seed", params.seed, 0, kMaxSeed);
  read.positive(prefix + "measured_cp_rate", params.rates.measured_cp, 1000.0);
  read.positive(prefix + "setpoint_cp_rate", params.rates.setpoint_cp, 1000.0);
  read.positive(prefix + "measured_js_rate", params.rates.measured_js, 1000.0);
  read.text(prefix + "base_frame", params.base_frame);
  read.text(prefix + "mocap_frame", params.mocap_frame);
  read.numbers(prefix + "mocap_registration", arm.registration, 6, -10.0, 10.0);
  read.flag(prefix + "discard_first_command", params.gate.discard_first);
  read.number(prefix + "max_step", params.gate.max_step, 0.0, 1.0);
  read.number(prefix + "reject_step", params.gate.reject_step, 0.0, 1.0);
  read.number(prefix + "stamp_tolerance", params.gate.stamp_tolerance, 0.0, 10.0);
}

/// What no single parameter shows. A frame has one parent in tf, so two arms either share the frame
/// of motion capture, and then the base frame and the registration, or each has its own.
void check(ParamReader& read, const std::string& prefix, const ArmReading& arm,
           const std::map<std::string, ArmReading>& earlier) {
  const SimulatedArmParams& params = arm.params;
  if (params.simulation.empty())
    read.problem(prefix + "simulation",
                 "is missing; set it to a file of the package's config/simulation");
  for (const auto& [name, text] : {std::make_pair("base_frame", params.base_frame),
                                   std::make_pair("mocap_frame", params.mocap_frame)})
    if (text.empty()) read.problem(prefix + name, "is empty");
  for (const auto& [name, other] : earlier) {
    if (other.params.mocap_frame != params.mocap_frame) continue;
    if (other.params.base_frame != params.base_frame || other.registration != arm.registration)
      read.problem(
          prefix + "mocap_frame",
          format("is \"%s\", as that of %s, whose base_frame or mocap_registration differs; "
                 "give each arm its own",
                 params.mocap_frame.c_str(), name.c_str()));
  }
}

}  // namespace

SimulatorParams loadSimulatorParams(const ros::NodeHandle& nh) {
  SimulatorParams params;
  ArmReading common;
  std::vector<std::string> names;
  ParamReader read(nh, "simulator");
  read.names("arms", names, kMaxArms);
  readArm(read, "", common);
  read.number("loop_rate", params.loop_rate, 50.0, 2000.0);
  read.number("clock_rate", params.clock_rate, 0.0, 20.0);
  read.number("clock_frequency", params.clock_frequency, 10.0, 1000.0);
  std::map<std::string, ArmReading> arms;
  if (names.empty()) names.emplace_back();  // one arm, in the node's own namespace
  for (const std::string& name : names) {
    ArmReading arm = common;
    const std::string prefix = name.empty() ? "" : name + "/";
    if (!name.empty()) {
      arm.params.name = name;
      // No arm has the random numbers of another, unless it is told so.
      arm.params.seed = std::min(common.params.seed, kMaxSeed - static_cast<int>(kMaxArms)) +
                        static_cast<int>(params.arms.size());
      readArm(read, prefix, arm);
    }
    check(read, prefix, arm, arms);
    arm.params.gate.base_frame = arm.params.base_frame;
    arm.params.X_base_mocap = poseFromYawPitchRoll(arm.registration);
    params.arms.push_back(arm.params);
    arms.emplace(name, arm);
  }
  read.refuseUnknownKeys({"diagnostic_period"});
  read.throwIfAnyProblem();
  if (params.clock_rate > 0.0 && !ros::Time::isSimTime())
    throw InvalidInput(
        format("simulator: ~clock_rate is %g, but /use_sim_time is not true, so no node would "
               "listen to /clock; set it before any node starts, as demo.launch does",
               params.clock_rate));
  ROS_INFO_STREAM(read.summary());
  return params;
}

}  // namespace raven_correction
