// SPDX-License-Identifier: BSD-3-Clause
#include "plant/draw.h"

#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/robot/gravity_load.h"

namespace raven_correction::plant {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kLeastLoad = 0.1;  // that can stretch a cable noticeably [Nm or N]

class Draw {
 public:
  Draw(const KinematicChain& robot, const Motion& motion, std::mt19937_64& random)
      : robot_(robot), motion_(motion), random_(random) {}

  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  double signedUnit() { return uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0; }
  int joint(int from = 0) {
    return std::uniform_int_distribution<int>(from, robot_.size() - 1)(random_);
  }
  int loadedJoint() {
    std::vector<int> loaded;
    const JointVector load = gravityLoad(robot_, motion_.joint_middle, 0.0);
    for (int j = 0; j < robot_.size(); ++j)
      if (std::abs(load(j)) > kLeastLoad) loaded.push_back(j);
    if (loaded.empty())
      throw InvalidInput("cable_stretch cannot be hidden: " + robot_.name() +
                         " has no joint with a load");
    return loaded[std::uniform_int_distribution<std::size_t>(0, loaded.size() - 1)(random_)];
  }
  /// A share of the joint's travel in this motion [rad or m].
  double travel(int joint, double share) const { return share * motion_.joint_span(joint); }
  bool isRevolute(int joint) const {
    return robot_.joints()[static_cast<std::size_t>(joint)].type == JointType::kRevolute;
  }
  Eigen::Vector3d direction() {
    std::normal_distribution<double> normal;
    const double x = normal(random_);
    const double y = normal(random_);
    const double z = normal(random_);
    return Eigen::Vector3d(x, y, z).normalized();
  }
  std::map<std::string, double> pose(double length, double angle) {
    const Eigen::Vector3d p = length * direction();
    const Eigen::Vector3d r = angle * direction();
    return {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}, {"rx", r.x()}, {"ry", r.y()}, {"rz", r.z()}};
  }

  HiddenEffect jointEffect(const std::string& effect) {
    const int j =
        effect == "cable_stretch" ? loadedJoint() : joint(effect == "link_geometry" ? 1 : 0);
    HiddenEffect hidden{effect, {j}, {}, 0.0, 0.0};
    auto& parameters = hidden.parameters;
    if (effect == "tracking_lag") {
      parameters["T"] = 0.02;
    } else if (effect == "speed_limit") {
      parameters["v"] = travel(j, 1.0);
    } else if (effect == "joint_offset") {
      parameters["d"] = signedUnit() * travel(j, 0.05);
    } else if (effect == "joint_gain") {
      parameters["g"] = signedUnit() * 0.05;
    } else if (effect == "cable_stretch") {
      parameters["s"] = isRevolute(j) ? 2e-3 : 2e-4;
    } else if (effect == "pulley_eccentricity") {
      parameters["A"] = travel(j, 0.02);
      parameters["N"] = kTwoPi * uniform(1.2, 3.0) / motion_.joint_span(j);
      parameters["phi"] = uniform(-0.5 * kTwoPi, 0.5 * kTwoPi);
    } else if (effect == "creep") {
      parameters["a"] = signedUnit() * travel(j, 0.05);
      parameters["T"] = uniform(0.15, 0.6) * motion_.duration();
    } else if (effect == "link_geometry") {
      const int which = std::uniform_int_distribution<int>(0, 2)(random_);
      const char* symbol = which == 0 ? "alpha" : which == 1 ? "a" : "d";
      parameters[symbol] = signedUnit() * (which == 0 ? 0.02 : 1e-3);
    } else {  // drive_friction, backlash
      parameters["w"] = travel(j, 0.05);
    }
    return hidden;
  }
  HiddenEffect coupling() {
    const int moved = joint();
    int source = joint();
    while (source == moved) source = joint();
    const double c = 0.05 * motion_.joint_span(moved) / motion_.joint_span(source);
    return {"joint_coupling", {moved, source}, {{"c", signedUnit() * c}}, 0.0, 0.0};
  }

 private:
  const KinematicChain& robot_;
  const Motion& motion_;
  std::mt19937_64& random_;
};

}  // namespace

std::mt19937_64 randomFor(const std::string& effect, std::uint64_t seed) {
  std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                      static_cast<std::uint32_t>(effect.size()),
                      static_cast<std::uint32_t>(effect.front()),
                      static_cast<std::uint32_t>(effect.back())};
  return std::mt19937_64(words);
}

HiddenEffect drawShape(const std::string& effect, const KinematicChain& robot, const Motion& motion,
                       std::mt19937_64& random) {
  Draw draw(robot, motion, random);
  if (isJointEffect(effect)) return draw.jointEffect(effect);
  HiddenEffect hidden{effect, {}, {}, 0.0, 0.0};
  if (effect == "joint_coupling") return draw.coupling();
  if (effect == "command_delay") {
    hidden.parameters["tau"] = 0.03;
  } else if (effect == "base_registration" || effect == "tool_offset") {
    hidden.parameters = draw.pose(1e-3, 0.02);
  } else if (effect == "registration_shift") {
    hidden.parameters = draw.pose(1e-3, 0.01);
    hidden.parameters["t0"] = draw.uniform(0.3, 0.7) * motion.duration();
  } else if (effect == "mocap_scale") {
    hidden.parameters["s"] = draw.signedUnit() * 0.01;
  } else {
    throw InvalidInput("the plant cannot hide an effect named " + effect);
  }
  return hidden;
}

}  // namespace raven_correction::plant
