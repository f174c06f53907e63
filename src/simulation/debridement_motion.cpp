// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/debridement_motion.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/simulation/minimum_jerk.h"

namespace raven_correction {
namespace {

constexpr int kMaxDraws = 1000;       // of a random pose before the field counts as unreachable
constexpr double kBlend = 0.7;        // the next move starts at this share of the one before
constexpr double kPeakSpeed = 1.875;  // of a minimum-jerk move of unit length and duration
constexpr double kPeakAcceleration = 5.7735;  // 10 / sqrt(3)

void requireInside(const char* what, const Eigen::Vector3d& p, const DebridementConfig& config) {
  for (int i = 0; i < 3; ++i) {
    if (p(i) >= config.box_lower(i) && p(i) <= config.box_upper(i)) continue;
    throw InvalidInput(format("debridement: %s %c = %g m is outside the command box [%g, %g]", what,
                              'x' + i, p(i), config.box_lower(i), config.box_upper(i)));
  }
}

}  // namespace

const std::vector<DebridementField>& debridementFields() {
  using C = DebridementConfig;
  static const std::vector<DebridementField> fields{
      {"lift_height", &C::lift_height, 0.0, 0.2},
      {"speed", &C::speed, 1e-3, 1.0},
      {"angular_speed", &C::angular_speed, 1e-2, 10.0},
      {"acceleration", &C::acceleration, 1e-2, 20.0},
      {"rate", &C::rate, 1.0, 1000.0},
      {"pause", &C::pause, 0.0, 10.0},
      {"dwell", &C::dwell, 0.0, 10.0},
      {"jaw_open", &C::jaw_open, -1.6, 3.2},
      {"jaw_closed", &C::jaw_closed, -1.6, 3.2}};
  return fields;
}

const char* toString(DebridementTrajectory::Kind kind) noexcept {
  switch (kind) {
    case DebridementTrajectory::Kind::kMoveTowardsFragment:
      return "move_towards_foam";
    case DebridementTrajectory::Kind::kCheckPickup:
      return "check_pickup";
    case DebridementTrajectory::Kind::kMoveHolding:
      break;
  }
  return "move_holding";
}

DebridementMotion::DebridementMotion(const DebridementConfig& config, const KinematicChain& robot,
                                     std::uint64_t seed)
    : config_(config), robot_(robot), ik_(robot), random_(seed) {
  for (const DebridementField& field : debridementFields()) {
    const double value = config.*field.value;
    if (!(value >= field.lower && value <= field.upper))
      throw InvalidInput(format("debridement: %s = %g is outside [%g, %g]", field.key, value,
                                field.lower, field.upper));
  }
  requireInside("field corner", config.field_centre - 0.5 * config.field_size, config);
  requireInside("field corner", config.field_centre + 0.5 * config.field_size, config);
  requireInside("receptacle", config.receptacle, config);
  rest_ = {config.receptacle, config.orientation.normalized()};
  if (!isReachable(rest_))
    throw InvalidInput("debridement: " + robot.name() +
                       " cannot reach the receptacle with the mean orientation");
}

bool DebridementMotion::isReachable(const Pose& X_base_tool) const {
  return ik_.solve(X_base_tool, robot_.home()).status == IkStatus::kOk;
}

Pose DebridementMotion::randomPose(const Eigen::Vector3d& centre, const Eigen::Vector3d& size) {
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    Pose X;
    Eigen::Vector3d turn;
    for (int i = 0; i < 3; ++i) {
      X.p(i) = std::clamp(centre(i) + uniform(random_) * size(i), config_.box_lower(i),
                          config_.box_upper(i));
      // Beyond two deviations a tool would come in at an odd angle: none does in the measurements.
      turn(i) = std::clamp(normal(random_), -2.0, 2.0) * config_.orientation_deviation(i);
    }
    X.q = (config_.orientation * expRotation(turn)).normalized();
    if (isReachable(X)) return X;
  }
  throw InvalidInput(
      format("debridement: %s reaches none of %d random poses about (%g, %g, %g) m; "
             "move the field or turn the mean orientation",
             robot_.name().c_str(), kMaxDraws, centre.x(), centre.y(), centre.z()));
}

Pose DebridementMotion::randomTarget() {
  return randomPose(config_.field_centre, config_.field_size);
}

double DebridementMotion::durationOf(const Pose& from, const Pose& to) const {
  const double length = (to.p - from.p).norm();
  const double angle = rotationAngle(from.q, to.q);
  return std::max({kPeakSpeed * length / config_.speed, kPeakSpeed * angle / config_.angular_speed,
                   std::sqrt(kPeakAcceleration * length / config_.acceleration), 0.1});
}

DebridementTrajectory DebridementMotion::follow(const std::vector<Pose>& waypoints, double start) {
  // Each waypoint adds a displacement of its own; they overlap, so the path rounds the corners.
  std::vector<Move> moves;
  Pose from = rest_;
  double begin = config_.pause;
  double end = begin;
  for (const Pose& to : waypoints) {
    const double duration = durationOf(from, to);
    moves.push_back({begin, duration, to.p - from.p, logRotation(from.q.conjugate() * to.q)});
    end = begin + duration;
    begin += kBlend * duration;
    from = to;
  }
  DebridementTrajectory trajectory;
  trajectory.target = waypoints.back();
  const int count = static_cast<int>(std::ceil((end + config_.dwell) * config_.rate)) + 1;
  const int rest = static_cast<int>(std::ceil(end * config_.rate));
  for (int k = 0; k < count; ++k) {
    const double t = k / config_.rate;
    Pose X = rest_;
    for (const Move& move : moves) {
      const double s = minimumJerk((t - move.begin) / move.duration);
      X.p += s * move.translation;
      X.q = X.q * expRotation(s * move.rotation);
    }
    X.p = X.p.cwiseMax(config_.box_lower).cwiseMin(config_.box_upper);
    X.q.normalize();
    if (k >= rest) X = trajectory.target;
    trajectory.commands.push_back({start + t, X});
  }
  trajectory.rest_start = start + rest / config_.rate;
  rest_ = trajectory.target;
  return trajectory;
}

DebridementTrajectory DebridementMotion::moveTo(const Pose& target, double start) {
  return follow({target}, start);
}

/// The jaw goes from one opening to another when half of the dwell is over, at the last command at
/// the latest.
void DebridementMotion::addJaw(double before, double after,
                               DebridementTrajectory& trajectory) const {
  const double change = trajectory.rest_start + 0.5 * config_.dwell;
  for (const StampedPose& command : trajectory.commands)
    trajectory.jaw.push_back(command.stamp < change ? before : after);
  trajectory.jaw.back() = after;
}

DebridementTrajectory DebridementMotion::next(double start) {
  const Eigen::Vector3d above(0.0, 0.0, config_.lift_height);
  const Eigen::Vector3d wander(0.02, 0.02, 0.01);  // of the poses in free space [m]
  using Kind = DebridementTrajectory::Kind;
  const Kind kind = static_cast<Kind>(phase_);
  DebridementTrajectory trajectory;
  switch (kind) {
    case Kind::kMoveTowardsFragment: {
      fragment_pose_ = randomTarget();
      const Pose approach = randomPose(fragment_pose_.p + above, wander);
      trajectory = follow({approach, fragment_pose_}, start);
      addJaw(config_.jaw_open, config_.jaw_closed, trajectory);
      break;
    }
    case Kind::kCheckPickup:
      trajectory = follow({randomPose(fragment_pose_.p + above, wander)}, start);
      addJaw(config_.jaw_closed, config_.jaw_closed, trajectory);
      break;
    case Kind::kMoveHolding:
      trajectory = follow({Pose{config_.receptacle, config_.orientation.normalized()}}, start);
      addJaw(config_.jaw_closed, config_.jaw_open, trajectory);
      break;
  }
  trajectory.kind = kind;
  trajectory.holding = kind != Kind::kMoveTowardsFragment;
  trajectory.fragment = fragments_;
  phase_ = (phase_ + 1) % 3;
  if (phase_ == 0) ++fragments_;
  return trajectory;
}

}  // namespace raven_correction
