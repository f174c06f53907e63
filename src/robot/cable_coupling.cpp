// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/robot/cable_coupling.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/robot/fingers.h"
#include "raven_correction/robot/yaml_reader.h"

namespace raven_correction {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;

int placeOf(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace

CableCoupling::CableCoupling(std::vector<std::string> joints, std::vector<std::string> motors,
                             const Eigen::MatrixXd& motors_per_joint, double counts_per_turn)
    : joints_(std::move(joints)),
      motors_(std::move(motors)),
      M_(motors_per_joint),
      counts_per_turn_(counts_per_turn) {
  const auto n = static_cast<Eigen::Index>(joints_.size());
  if (M_.rows() != n || M_.cols() != n || motors_.size() != joints_.size())
    throw InvalidInput(format("transmission: %d motors, %d joints and a %d x %d matrix",
                              static_cast<int>(motors_.size()), static_cast<int>(n),
                              static_cast<int>(M_.rows()), static_cast<int>(M_.cols())));
  if (!M_.allFinite()) throw InvalidInput("transmission: a value is not finite");
  if (!(counts_per_turn > 0.0))
    throw InvalidInput(format("transmission: counts_per_turn = %g, must be > 0", counts_per_turn));
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(M_);
  if (!lu.isInvertible())
    throw InvalidInput("transmission: the motors do not determine the joints (singular matrix)");
  M_inverse_ = lu.inverse();
}

Eigen::VectorXd CableCoupling::quantised(const Eigen::VectorXd& q) const {
  const double per_count = kTwoPi / counts_per_turn_;
  const Eigen::VectorXd counts = (M_ * q / per_count).array().round();
  return M_inverse_ * (per_count * counts);
}

JointVector CableCoupling::quantised(const KinematicChain& chain, const JointVector& q,
                                     double jaw) const {
  const int finger_1 = placeOf(joints_, "finger_1");
  const int finger_2 = placeOf(joints_, "finger_2");
  Eigen::VectorXd actuated = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(joints_.size()));
  for (int j = 0; j < chain.size(); ++j) {
    const int place = placeOf(joints_, chain.joints()[static_cast<std::size_t>(j)].name);
    if (place >= 0) {
      actuated(place) = q(j);
    } else if (finger_1 >= 0 && finger_2 >= 0) {
      const Fingers fingers = Fingers::from(q(j), jaw);
      actuated(finger_1) = fingers.g1;
      actuated(finger_2) = fingers.g2;
    }
  }
  const Eigen::VectorXd seen = quantised(actuated);
  JointVector result = q;
  for (int j = 0; j < chain.size(); ++j) {
    const int place = placeOf(joints_, chain.joints()[static_cast<std::size_t>(j)].name);
    if (place >= 0)
      result(j) = seen(place);
    else if (finger_1 >= 0 && finger_2 >= 0)
      result(j) = Fingers{seen(finger_1), seen(finger_2)}.yaw();
  }
  return result;
}

JointMatrix CableCoupling::motorTravel(const KinematicChain& chain) const {
  const int finger_1 = placeOf(joints_, "finger_1");
  const int finger_2 = placeOf(joints_, "finger_2");
  const bool has_fingers = finger_1 >= 0 && finger_2 >= 0;
  const Eigen::Index n = chain.size();
  // Columns of `spread` are the actuated joints that one joint of the chain moves, rows of `gather`
  // the motors that make up its travel.
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(M_.cols(), n);
  Eigen::MatrixXd gather = Eigen::MatrixXd::Zero(n, M_.rows());
  for (int j = 0; j < chain.size(); ++j) {
    const std::string& name = chain.joints()[static_cast<std::size_t>(j)].name;
    const int place = placeOf(joints_, name);
    const int motor = placeOf(motors_, name);
    if (place >= 0) {
      spread(place, j) = 1.0;
      if (motor >= 0) gather(j, motor) = 1.0 / M_(motor, place);
    } else if (has_fingers) {
      spread(finger_1, j) = Fingers::from(1.0, 0.0).g1;
      spread(finger_2, j) = Fingers::from(1.0, 0.0).g2;
      const int motor_1 = placeOf(motors_, "finger_1");
      const int motor_2 = placeOf(motors_, "finger_2");
      if (motor_1 < 0 || motor_2 < 0) continue;
      gather(j, motor_1) = -0.5 / M_(motor_1, finger_1);
      gather(j, motor_2) = 0.5 / M_(motor_2, finger_2);
    }
  }
  JointMatrix travel = gather * M_ * spread;
  for (Eigen::Index j = 0; j < n; ++j)
    if (motors_.empty() || gather.row(j).isZero()) travel(j, j) = 1.0;
  return travel;
}

namespace {

CableCoupling readCoupling(YamlReader file, const std::string& robot_path) {
  if (!file.has("transmission")) return {};
  YamlReader reader = file.section("transmission");
  double counts_per_turn = 0.0;
  reader.requiredNumber("counts_per_turn", counts_per_turn, 1.0, 1e7);
  std::vector<YamlReader> rows = reader.list("motors");
  std::vector<std::string> motors;
  for (YamlReader& row : rows) {
    motors.emplace_back();
    row.requiredText("motor", motors.back());
  }
  // The motors are named after the joints that they drive, so those are the columns as well.
  const auto n = static_cast<Eigen::Index>(motors.size());
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    YamlReader& row = rows[static_cast<std::size_t>(i)];
    YamlReader turns = row.section("turns");
    for (Eigen::Index j = 0; j < n; ++j)
      turns.number(motors[static_cast<std::size_t>(j)], M(i, j), -1e5, 1e5);
    turns.refuseUnknownKeys();
    row.refuseUnknownKeys();
  }
  if (motors.empty()) reader.problem("motors", "missing; one list entry per motor");
  reader.refuseUnknownKeys();
  reader.throwIfAnyProblem();
  try {
    return CableCoupling(motors, motors, M, counts_per_turn);
  } catch (const InvalidInput& error) {
    throw InvalidInput(format("%s: %s", robot_path.c_str(), error.what()));
  }
}

}  // namespace

CableCoupling loadCableCoupling(const std::string& robot_path) {
  return readCoupling(YamlReader::fromFile(robot_path), robot_path);
}

CableCoupling cableCouplingFromText(const std::string& text, const std::string& name) {
  return readCoupling(YamlReader::fromText(text, name), name);
}

}  // namespace raven_correction
