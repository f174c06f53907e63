// SPDX-License-Identifier: BSD-3-Clause
#include "plant/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/robot/inverse_kinematics.h"

namespace raven_correction::plant {
namespace {

constexpr int kMostAttempts = 1000;
constexpr double kLongestMove = 2.0;    // [s]; slow moves are short ones
constexpr double kTurnPerMetre = 12.0;  // angular speed over speed of a move [rad/m]
constexpr double kShortest = 1.5;     // of a trajectory; moves are added until it is that long [s]
constexpr double kLargestStep = 0.2;  // of a joint from command to command [rad or m]
constexpr int kJointMoves = 2;        // in a trajectory of joints alone
constexpr int kStopsPerMove = 12;     // of a session of stops
constexpr std::array<double, 6> kSpeeds{0.010, 0.020, 0.035, 0.060, 0.090, 0.130};  // [m/s]

/// Mean of the tool in the CASE 2014 session, over the field of fragments and above it.
const Pose& measuredMiddle() {
  static const Pose middle{{-0.020, -0.058, -0.145},
                           Eigen::Quaterniond(0.5084, 0.4938, 0.4797, -0.5173).normalized()};
  return middle;
}

Pose middleOf(const KinematicChain& robot) {
  if (robot.name() == "raven2_left") return measuredMiddle();
  JointVector posture = robot.home();
  for (int j = 0; j < robot.size(); ++j)
    if (robot.joints()[static_cast<std::size_t>(j)].type == JointType::kPrismatic)
      posture(j) = 0.5 * (posture(j) + 0.5 * (robot.lower()(j) + robot.upper()(j)));
  return robot.forward(posture);
}

/// Share of the way at time t of a move of this duration: accelerates, runs evenly, brakes.
struct Trapezoid {
  double duration;
  double ramp;  // time of acceleration, at most half of the duration [s]

  /// @param length  of the way [m], or anything in the units of speed and acceleration
  static Trapezoid over(double length, double speed, double acceleration) {
    const double ramp = speed / acceleration;
    if (length >= speed * ramp) return {length / speed + ramp, ramp};
    const double half = std::sqrt(length / acceleration);
    return {2.0 * half, half};
  }
  double share(double t) const {
    if (t <= 0.0) return 0.0;
    if (t >= duration) return 1.0;
    const double peak = 1.0 / (duration - ramp);
    if (t < ramp) return 0.5 * peak * t * t / ramp;
    if (t > duration - ramp) return 1.0 - 0.5 * peak * (duration - t) * (duration - t) / ramp;
    return peak * (t - 0.5 * ramp);
  }
};

/// Stamps of commands: an even grid with jitter, from trajectory to trajectory.
class Clock {
 public:
  Clock(const MotionOptions& options, std::uint64_t seed)
      : period_(1.0 / options.rate),
        jitter_(options.stamp_jitter),
        time_(options.start),
        random_(seed) {}
  double now() const { return time_; }
  double stamp() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    return time_ + std::min(jitter_, 0.4 * period_) * uniform(random_);
  }
  void tick() { time_ += period_; }
  void wait(double duration) { time_ += duration; }

 private:
  double period_;
  double jitter_;
  double time_;
  std::mt19937_64 random_;
};

void check(const MotionOptions& options) {
  if (options.trajectories <= 0)
    throw InvalidInput(format("plant: %d trajectories, must be > 0", options.trajectories));
  if (!(options.rate > 0.0))
    throw InvalidInput(format("plant: %g commands per second, must be > 0", options.rate));
}

void summarise(Motion& motion) {
  const Eigen::Index n = motion.trajectories.front().joints.front().size();
  motion.joint_middle.resize(n);
  motion.joint_span.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    std::vector<double> values;
    for (const PlannedTrajectory& trajectory : motion.trajectories)
      for (const JointVector& q : trajectory.joints) values.push_back(q(j));
    motion.joint_middle(j) = median(values);
    motion.joint_span(j) = quantile(values, 0.95) - quantile(values, 0.05);
  }
}

class CartesianPlanner {
 public:
  CartesianPlanner(const KinematicChain& robot, const MotionOptions& options)
      : robot_(robot),
        ik_(robot),
        options_(options),
        random_(options.seed),
        clock_(options, options.seed + 1),
        middle_(middleOf(robot)) {}

  Motion plan() {
    Motion motion;
    motion.middle = middle_.p;
    rest_joints_ = robot_.home();
    for (int attempt = 0; !standAt(randomPose()); ++attempt) complainAfter(attempt);
    motion.approach = rest_joints_;
    for (int attempt = 0; !standAt(randomPose()); ++attempt) complainAfter(attempt);
    for (int i = 0; i < options_.trajectories; ++i) {
      PlannedTrajectory trajectory;
      trajectory.id = format("t%03d", i);
      const double begin = clock_.now();
      hold(uniform(0.2, 0.35), trajectory);
      do {
        move(trajectory);
        hold(uniform(0.2, 0.4), trajectory);
      } while (clock_.now() - begin < kShortest);
      clock_.wait(uniform(0.3, 1.0));
      motion.trajectories.push_back(std::move(trajectory));
    }
    summarise(motion);
    return motion;
  }

 private:
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Eigen::Vector3d box(const Eigen::Vector3d& size) {
    const double x = uniform(-0.5, 0.5);
    const double y = uniform(-0.5, 0.5);
    const double z = uniform(-0.5, 0.5);
    return size.cwiseProduct(Eigen::Vector3d(x, y, z));
  }
  Pose randomPose() {
    const Eigen::Vector3d p = middle_.p + box(options_.field_size);
    return {p, middle_.q * expRotation(box(Eigen::Vector3d::Constant(options_.orientation_range)))};
  }
  void complainAfter(int attempt) const {
    if (attempt >= kMostAttempts)
      throw InvalidInput(format("plant: %s cannot reach a field of %g x %g x %g m about its middle",
                                robot_.name().c_str(), options_.field_size.x(),
                                options_.field_size.y(), options_.field_size.z()));
  }
  bool standAt(const Pose& pose) {
    const IkResult result = ik_.solve(pose, rest_joints_);
    if (result.status != IkStatus::kOk) return false;
    rest_ = pose;
    rest_joints_ = result.joints;
    return true;
  }
  void put(const Pose& pose, const JointVector& joints, PlannedTrajectory& trajectory) {
    trajectory.commands.push_back({clock_.stamp(), pose});
    trajectory.joints.push_back(joints);
    clock_.tick();
  }
  void hold(double duration, PlannedTrajectory& trajectory) {
    const double until = clock_.now() + duration;
    while (clock_.now() < until) put(rest_, rest_joints_, trajectory);
  }
  /// A straight move to a random pose, or part of the way where the speed is low.
  void move(PlannedTrajectory& trajectory) {
    const double speed = kSpeeds[std::uniform_int_distribution<std::size_t>(0, 5)(random_)];
    const double acceleration = uniform(0.3, 1.2);
    for (int attempt = 0;; ++attempt) {
      complainAfter(attempt);
      const Pose aim = randomPose();
      const double length =
          std::max((aim.p - rest_.p).norm(), rotationAngle(rest_.q, aim.q) / kTurnPerMetre);
      const double part = std::min(1.0, kLongestMove * speed / length);
      if (follow(interpolate(rest_, aim, part), Trapezoid::over(part * length, speed, acceleration),
                 trajectory))
        return;
    }
  }
  bool follow(const Pose& target, const Trapezoid& profile, PlannedTrajectory& trajectory) {
    std::vector<Pose> poses;
    std::vector<JointVector> joints;
    JointVector q = rest_joints_;
    const double period = 1.0 / options_.rate;
    for (double t = period; poses.empty() || t < profile.duration + period; t += period) {
      const Pose pose = interpolate(rest_, target, profile.share(t));
      const IkResult result = ik_.solve(pose, q);
      if (result.status != IkStatus::kOk) return false;
      if ((result.joints - q).cwiseAbs().maxCoeff() > kLargestStep) return false;
      q = result.joints;
      poses.push_back(pose);
      joints.push_back(q);
    }
    for (std::size_t k = 0; k < poses.size(); ++k) put(poses[k], joints[k], trajectory);
    rest_ = poses.back();
    rest_joints_ = q;
    return true;
  }

  const KinematicChain& robot_;
  InverseKinematics ik_;
  MotionOptions options_;
  std::mt19937_64 random_;
  Clock clock_;
  Pose middle_;
  Pose rest_;
  JointVector rest_joints_;
};

}  // namespace

Motion planMotion(const KinematicChain& robot, const MotionOptions& options) {
  check(options);
  return CartesianPlanner(robot, options).plan();
}

Motion planJointMotion(const JointVector& amplitude, bool stops, const MotionOptions& options) {
  check(options);
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto randomJoints = [&] {
    JointVector q(amplitude.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) q(j) = amplitude(j) * uniform(random);
    return q;
  };
  Clock clock(options, options.seed + 1);
  Motion motion;
  motion.approach = randomJoints();
  JointVector rest = randomJoints();
  for (int i = 0; i < options.trajectories; ++i) {
    PlannedTrajectory trajectory;
    trajectory.id = format("p%03d", i);
    const auto put = [&](const JointVector& q) {
      trajectory.commands.push_back({clock.stamp(), Pose()});
      trajectory.joints.push_back(q);
      clock.tick();
    };
    for (int k = 0; k < kJointMoves; ++k) {
      const JointVector target = randomJoints();
      if (stops) {
        for (int stop = 1; stop <= kStopsPerMove; ++stop)
          put(rest + stop / static_cast<double>(kStopsPerMove) * (target - rest));
      } else {
        const double pace = std::exp(0.4 + 0.8 * uniform(random));  // shares of the amplitude [1/s]
        const double length = (target - rest).cwiseQuotient(amplitude).cwiseAbs().maxCoeff();
        const Trapezoid profile = Trapezoid::over(length, pace, 6.0);
        const double begin = clock.now();
        while (clock.now() - begin < profile.duration + 0.2)
          put(rest + profile.share(clock.now() - begin) * (target - rest));
      }
      rest = target;
    }
    clock.wait(stops ? 0.0 : 0.4 + 0.2 * uniform(random));
    motion.trajectories.push_back(std::move(trajectory));
  }
  summarise(motion);
  return motion;
}

}  // namespace raven_correction::plant
