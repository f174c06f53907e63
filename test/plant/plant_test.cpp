// SPDX-License-Identifier: BSD-3-Clause
// Each hidden effect is what the map of hidden_effect.h says, measured from the plant's noise-free
// output; without one the plant is the ideal robot at the level of the noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "plant/session.h"
#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/robot/gravity_load.h"

namespace raven_correction::plant {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kSettled = 3e-3;  // after a set-point the clean plant stands where it was told [s]

PlantOptions quiet(int trajectories) {
  PlantOptions options;
  options.trajectories = trajectories;
  options.noise = 0.0;
  options.dirt = false;
  return options;
}

PlantSession recordOne(const std::string& effect, const std::vector<int>& joints,
                       const std::map<std::string, double>& parameters, int trajectories = 6,
                       bool encoders = false) {
  PlantOptions options = quiet(trajectories);
  options.encoders = encoders;
  return recordHidden(options, {{effect, joints, parameters, 0.0, 0.0}});
}

const KinematicChain& robot() {
  static const KinematicChain chain = loadKinematicChain(PlantOptions().robot_file);
  return chain;
}

/// One exposure, and the command that was held then.
struct Sample {
  std::size_t trajectory;
  double time;     // since the first command of the session [s]
  double held;     // for how long the set-point has been the same command [s]
  double resting;  // for how long commands have not changed [s]
  Eigen::VectorXd setpoint;
  Eigen::VectorXd joint;
  Pose command;
  Pose observed;
};

/// All exposures with the set-points that were sent `delay` earlier.
std::vector<Sample> samplesOf(const PlantSession& session, double delay = 0.0) {
  std::vector<Sample> samples;
  const double start = session.noise_free.trajectories.front().commands.front().stamp;
  for (std::size_t i = 0; i < session.noise_free.trajectories.size(); ++i) {
    const Trajectory& trajectory = session.noise_free.trajectories[i];
    std::size_t c = 0;
    double changed = trajectory.commands.front().stamp;
    for (std::size_t k = 0; k < trajectory.observations.size(); ++k) {
      const double stamp = trajectory.observations[k].stamp;
      while (c + 1 < trajectory.commands.size() &&
             trajectory.commands[c + 1].stamp + delay <= stamp) {
        ++c;
        const bool moved = (trajectory.joint_commands.samples[c].positions -
                            trajectory.joint_commands.samples[c - 1].positions)
                               .norm() > 1e-9;
        if (moved) changed = trajectory.commands[c].stamp;
      }
      const double sent = trajectory.commands[c].stamp + delay;
      if (sent > stamp) continue;
      samples.push_back({i, stamp - start, stamp - sent, stamp - delay - changed,
                         trajectory.joint_commands.samples[c].positions,
                         trajectory.joint_observations.samples[k].positions,
                         trajectory.commands[c].pose, trajectory.observations[k].pose});
    }
  }
  return samples;
}

/// Largest difference between joints and `expected(sample)` at settled exposures.
template <typename Expected>
double largestError(const std::vector<Sample>& samples, int joint, const Expected& expected) {
  double largest = 0.0;
  std::size_t count = 0;
  for (const Sample& sample : samples) {
    if (sample.held < kSettled) continue;
    largest = std::max(largest, std::abs(sample.joint(joint) - expected(sample)));
    ++count;
  }
  EXPECT_GT(count, 200u);
  return largest;
}

// --- the clean plant
// ------------------------------------------------------------------------------

TEST(Plant, CleanIsTheIdealRobot) {
  const PlantSession session = recordClean(quiet(20));
  std::size_t count = 0;
  double squared = 0.0;
  const std::vector<Sample> samples = samplesOf(session);
  for (const Sample& sample : samples) {
    squared += (sample.observed.p - sample.command.p).squaredNorm();
    if (sample.held < kSettled) continue;
    EXPECT_LT((sample.observed.p - sample.command.p).norm(), 1e-5);
    EXPECT_LT(rotationAngle(sample.observed.q, sample.command.q), 0.01 * kDegree);
    ++count;
  }
  EXPECT_GT(count, 1000u);
  // All of them, also those that catch the tool on its way to a new set-point.
  EXPECT_LT(std::sqrt(squared / static_cast<double>(samples.size())), 4e-5);
}

TEST(Plant, CleanLagsSomeMicroseconds) {
  for (const bool revolute : {true, false}) {
    JointDrive drive(cleanJoint(revolute, 0.0), 0.0);
    const double h = RobotPlant::kFirstStep;
    double r = 0.0;
    for (int k = 0; k < 10000; ++k) {
      r += 0.5 * h;  // a ramp of 0.5 rad/s
      drive.setSetpoint(r);
      drive.step(h, 1.5, 0.0, true);
    }
    const double lag = (r - drive.joint()) / 0.5;
    EXPECT_GT(lag, 0.0);
    EXPECT_LT(lag, 6e-5);
  }
}

TEST(Plant, CleanNoiseIsWhatWasAskedFor) {
  PlantOptions options;
  options.trajectories = 10;
  options.dirt = false;
  const PlantSession session = recordClean(options);
  Eigen::Vector3d squared = Eigen::Vector3d::Zero();
  double squared_angle = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i < session.dataset.trajectories.size(); ++i) {
    const PoseStream& seen = session.dataset.trajectories[i].observations;
    const PoseStream& perfect = session.noise_free.trajectories[i].observations;
    ASSERT_EQ(seen.size(), perfect.size());
    for (std::size_t k = 0; k < seen.size(); ++k, n += 1.0) {
      squared += (seen[k].pose.p - perfect[k].pose.p).cwiseAbs2();
      squared_angle += logRotation(perfect[k].pose.q.conjugate() * seen[k].pose.q).squaredNorm();
    }
  }
  // Deviation of a sample's deviation: 1 / sqrt(2 n); five of them.
  const double tolerance = 5.0 / std::sqrt(2.0 * n);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::sqrt(squared(axis) / n) / 1e-4, 1.0, tolerance);
  EXPECT_NEAR(std::sqrt(squared_angle / (3.0 * n)) / (0.3 * kDegree), 1.0, tolerance);
}

TEST(Plant, IsDeterministic) {
  PlantOptions options;
  options.trajectories = 3;
  options.encoders = true;
  const HiddenEffect hidden{"backlash", {1}, {{"w", 0.02}}, 0.0, 0.0};
  const PlantSession a = recordHidden(options, {hidden});
  const PlantSession b = recordHidden(options, {hidden});
  options.seed = 2;
  const PlantSession c = recordHidden(options, {hidden});
  bool differs = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const PoseStream& seen = a.dataset.trajectories[i].observations;
    ASSERT_EQ(seen.size(), b.dataset.trajectories[i].observations.size());
    for (std::size_t k = 0; k < seen.size(); ++k)
      EXPECT_EQ(seen[k].pose.p, b.dataset.trajectories[i].observations[k].pose.p);
    differs = differs || seen.size() != c.dataset.trajectories[i].observations.size() ||
              seen[0].pose.p != c.dataset.trajectories[i].observations[0].pose.p;
  }
  EXPECT_TRUE(differs);
  EXPECT_EQ(describe(drawHidden(quiet(4), 5, 5.0, 10.0)),
            describe(drawHidden(quiet(4), 5, 5.0, 10.0)));
}

TEST(Plant, MotionMovesEveryJointBothWaysAtSeveralSpeeds) {
  MotionOptions options;
  options.trajectories = 40;
  const Motion motion = planMotion(robot(), options);
  EXPECT_GT(motion.duration() / 40.0, 2.0);
  EXPECT_LT(motion.duration() / 40.0, 4.0);
  for (int j = 0; j < robot().size(); ++j) {
    const bool revolute =
        robot().joints()[static_cast<std::size_t>(j)].type == JointType::kRevolute;
    EXPECT_GT(motion.joint_span(j), revolute ? 0.2 : 0.02) << j;
    int up = 0;
    int down = 0;
    for (const PlannedTrajectory& trajectory : motion.trajectories) {
      const double way = trajectory.joints.back()(j) - trajectory.joints.front()(j);
      up += way > 0.0;
      down += way < 0.0;
    }
    EXPECT_GE(std::min(up, down), 10) << j;
  }
  std::vector<double> speeds;
  for (const PlannedTrajectory& trajectory : motion.trajectories) {
    double fastest = 0.0;
    for (std::size_t k = 5; k < trajectory.commands.size(); ++k)
      fastest = std::max(
          fastest, (trajectory.commands[k].pose.p - trajectory.commands[k - 5].pose.p).norm() /
                       (trajectory.commands[k].stamp - trajectory.commands[k - 5].stamp));
    speeds.push_back(fastest);
    EXPECT_LT(fastest, 0.15);
  }
  std::sort(speeds.begin(), speeds.end());
  EXPECT_LT(speeds.front(), 0.03);
  EXPECT_GT(speeds.back(), 0.08);
}

TEST(Plant, WorksForOtherRobots) {
  for (const char* name : {"raven2_right", "raven2_gold", "raven2_green", "psm"}) {
    PlantOptions options = quiet(2);
    options.robot_file = std::string("config/robots/") + name + ".yaml";
    EXPECT_EQ(recordClean(options).dataset.trajectories.size(), 2u) << name;
  }
}

// --- command and drive
// ----------------------------------------------------------------------------

TEST(PlantEffects, CommandDelayIsAQueue) {
  const double tau = 0.043;
  const auto samples = samplesOf(recordOne("command_delay", {}, {{"tau", tau}}), tau);
  for (int j = 0; j < 6; ++j)
    EXPECT_LT(largestError(samples, j, [&](const Sample& s) { return s.setpoint(j); }), 2e-5);
}

TEST(PlantEffects, TrackingLagIsTheRatioOfDampingAndStiffness) {
  const double T = 0.05;
  RobotPhysics physics = cleanRobot(robot());
  applyEffect({"tracking_lag", {3}, {{"T", T}}, 0.0, 0.0}, physics);
  const JointPhysics& joint = physics.joints[3];
  EXPECT_NEAR((joint.damping + joint.joint_viscous) / joint.stiffness, T, 1e-9);
  JointDrive drive(joint, 0.0);
  drive.setSetpoint(0.01);
  for (double t = 0.0; t < T - 0.5 * RobotPlant::kStep; t += RobotPlant::kStep)
    drive.step(RobotPlant::kStep, 0.0, 0.0, true);
  EXPECT_NEAR(drive.joint() / 0.01, 1.0 - std::exp(-1.0), 0.005);  // a first-order step response
  EXPECT_NEAR(drive.motor(), drive.joint(), 1e-6);                 // seen by the encoder
}

TEST(PlantEffects, DriveFrictionHoldsTheMotorHalfAWidthShort) {
  const double w = 0.02;
  for (const double load : {-1.5, 0.0, 1.5}) {
    RobotPhysics physics = cleanRobot(robot());
    applyEffect({"drive_friction", {1}, {{"w", w}}, 0.0, 0.0}, physics);
    JointDrive drive(physics.joints[1], 0.0);
    double reached[2];
    for (const int way : {1, 0}) {  // to the same set-point from below and from above
      for (int k = 0; k <= 60; ++k) {
        drive.setSetpoint(0.3 + (way == 1 ? -1.0 : 1.0) * 0.3 * (60 - k) / 60.0);
        for (int i = 0; i < 160; ++i) drive.step(RobotPlant::kStep, load, 0.0, true);
      }
      reached[way] = drive.motor();
      EXPECT_NEAR(drive.joint(), drive.motor(), 1e-4);  // the cable follows the motor
    }
    EXPECT_LT(reached[1], reached[0]);
    EXPECT_NEAR(reached[0] - reached[1], w, 0.02 * w);
  }
}

TEST(PlantEffects, SpeedLimitIsTheSpeedWithoutLoad) {
  const double v = 0.2;
  RobotPhysics physics = cleanRobot(robot());
  applyEffect({"speed_limit", {0}, {{"v", v}}, 0.0, 0.0}, physics);
  JointDrive drive(physics.joints[0], 0.0);
  drive.setSetpoint(0.1);
  for (int k = 0; k < 1000; ++k) drive.step(RobotPlant::kStep, -1.5, 0.0, true);
  const double before = drive.joint();
  for (int k = 0; k < 1000; ++k) drive.step(RobotPlant::kStep, -1.5, 0.0, true);
  EXPECT_NEAR((drive.joint() - before) / 0.1, v, 0.01 * v);
  for (int k = 0; k < 4000; ++k) drive.step(RobotPlant::kStep, -1.5, 0.0, true);
  EXPECT_NEAR(drive.joint(), 0.1, 1e-4);  // it gets there
}

// --- cable
// ----------------------------------------------------------------------------------------

TEST(PlantEffects, TransmissionErrorsAreThoseOfTheCatalogue) {
  const double home = robot().home()(1);
  const auto offset = samplesOf(recordOne("joint_offset", {1}, {{"d", 0.03}}));
  EXPECT_LT(largestError(offset, 1, [](const Sample& s) { return s.setpoint(1) + 0.03; }), 5e-5);
  const auto gain = samplesOf(recordOne("joint_gain", {1}, {{"g", -0.04}}));
  EXPECT_LT(
      largestError(gain, 1,
                   [&](const Sample& s) { return s.setpoint(1) - 0.04 * (s.setpoint(1) - home); }),
      5e-5);
  const auto ripple =
      samplesOf(recordOne("pulley_eccentricity", {1}, {{"A", 0.01}, {"N", 15.0}, {"phi", 0.7}}));
  EXPECT_LT(largestError(ripple, 1,
                         [](const Sample& s) {
                           return s.setpoint(1) + 0.01 * std::sin(15.0 * s.setpoint(1) + 0.7);
                         }),
            1e-4);
  const auto coupled = samplesOf(recordOne("joint_coupling", {3, 1}, {{"c", 0.01}}));
  EXPECT_LT(
      largestError(coupled, 3,
                   [&](const Sample& s) { return s.setpoint(3) + 0.01 * (s.setpoint(1) - home); }),
      5e-6);
  EXPECT_LT(largestError(coupled, 1, [](const Sample& s) { return s.setpoint(1); }), 5e-5);
}

/// Largest difference between the joint and a play of width w behind its set-points, at settled
/// exposures [share of w]. Every set-point has an exposure, so the play misses none.
double playError(const std::vector<Sample>& samples, int joint, double w) {
  double q = samples.front().joint(joint);  // where in the play it starts, nobody tells
  double largest = 0.0;
  double furthest = 0.0;
  for (const Sample& sample : samples) {
    const double u = sample.setpoint(joint);
    q = std::min(u + 0.5 * w, std::max(u - 0.5 * w, q));
    if (sample.held < kSettled) continue;
    largest = std::max(largest, std::abs(sample.joint(joint) - q));
    furthest = std::max(furthest, std::abs(sample.joint(joint) - u));
  }
  EXPECT_NEAR(furthest, 0.5 * w, 0.02 * w);
  return largest / w;
}

TEST(PlantEffects, BacklashIsAPlayAlsoUnderGravity) {
  const auto revolute = samplesOf(recordOne("backlash", {1}, {{"w", 0.03}}, 10));
  EXPECT_LT(playError(revolute, 1, 0.03), 0.03);
  const auto prismatic = samplesOf(recordOne("backlash", {3}, {{"w", 0.002}}, 10));
  EXPECT_LT(playError(prismatic, 3, 0.002), 0.03);
}

TEST(PlantEffects, SharpBoucWenIsAPlayToo) {
  const auto samples = samplesOf(recordOne("backlash", {2}, {{"w", 0.05}, {"n", 8.0}}, 10));
  EXPECT_LT(playError(samples, 2, 0.05), 0.06);
}

TEST(PlantEffects, CableStretchGivesWayTheWayTheLoadPulls) {
  for (const int j : {0, 1, 3}) {
    const double s = j == 3 ? 5e-4 : 5e-3;
    double largest_load = 0.0;
    std::size_t count = 0;
    for (const Sample& sample : samplesOf(recordOne("cable_stretch", {j}, {{"s", s}}))) {
      if (sample.resting < 0.1) continue;
      const double load = gravityLoad(robot(), sample.joint, 0.0)(j);
      EXPECT_NEAR(sample.joint(j) - sample.setpoint(j), s * load, s * 0.03);
      largest_load = std::max(largest_load, std::abs(load));
      ++count;
    }
    EXPECT_GT(count, 50u);
    EXPECT_GT(largest_load, 0.3);
  }
}

TEST(PlantEffects, CableStretchSettlesWithinHundredthsOfASecond) {
  RobotPhysics physics = cleanRobot(robot());
  applyEffect({"cable_stretch", {0}, {{"s", 5e-3}}, 0.0, 0.0}, physics);
  JointDrive drive(physics.joints[0], 0.0);
  for (int k = 0; k < 1000; ++k) drive.step(RobotPlant::kStep, 1.0, 0.0, true);
  drive.setSetpoint(0.01);
  for (int k = 0; k < 200; ++k) drive.step(RobotPlant::kStep, 1.0, 0.0, true);  // 20 ms
  EXPECT_NEAR(drive.joint(), 0.015, 2e-4);
}

TEST(PlantEffects, CreepComesWithTimeFromTheStartOfTheSession) {
  const double a = 0.02;
  const double T = 8.0;
  const auto samples = samplesOf(recordOne("creep", {1}, {{"a", a}, {"T", T}}, 10));
  EXPECT_GT(samples.back().time, 2.0 * T);
  EXPECT_LT(
      largestError(samples, 1,
                   [&](const Sample& s) { return s.setpoint(1) - a * std::expm1(-s.time / T); }),
      0.03 * a);
}

// --- kinematics and observation
// -------------------------------------------------------------------

TEST(PlantEffects, GeometryAndRegistrationAreThoseOfTheCatalogue) {
  const Pose X_err{{0.004, -0.003, 0.002}, expRotation(Eigen::Vector3d(0.02, -0.03, 0.01))};
  const std::map<std::string, double> err{{"x", 0.004}, {"y", -0.003}, {"z", 0.002},
                                          {"rx", 0.02}, {"ry", -0.03}, {"rz", 0.01}};
  const auto compare = [](const std::vector<Sample>& samples, const auto& expected) {
    for (const Sample& sample : samples) {
      if (sample.held < kSettled) continue;
      const Pose X = expected(sample);
      EXPECT_LT((X.p - sample.observed.p).norm(), 1e-5);
      EXPECT_LT(rotationAngle(X.q, sample.observed.q), 1e-4);
    }
  };
  compare(samplesOf(recordOne("base_registration", {}, err)),
          [&](const Sample& s) { return X_err * s.command; });
  compare(samplesOf(recordOne("tool_offset", {}, err)),
          [&](const Sample& s) { return s.command * X_err; });
  std::map<std::string, double> bump = err;
  bump["t0"] = 7.0;
  compare(samplesOf(recordOne("registration_shift", {}, bump)),
          [&](const Sample& s) { return s.time >= 7.0 ? X_err * s.command : s.command; });
  compare(samplesOf(recordOne("mocap_scale", {}, {{"s", 0.02}})), [](const Sample& s) {
    return Pose{1.02 * s.command.p, s.command.q};
  });
  std::vector<Joint> rows = robot().joints();
  rows[1].alpha += 0.02;
  const KinematicChain bent(robot().name(), robot().frame(), robot().baseTransform(), rows,
                            robot().toolTransform());
  compare(samplesOf(recordOne("link_geometry", {1}, {{"alpha", 0.02}})),
          [&](const Sample& s) { return bent.forward(JointVector(s.setpoint)); });
}

// --- encoders
// -------------------------------------------------------------------------------------

TEST(PlantEncoders, SeeTheDriveAndNotTheCable) {
  const auto largestAway = [](const PlantSession& session) {
    double largest = 0.0;
    for (const Trajectory& trajectory : session.dataset.trajectories) {
      EXPECT_EQ(trajectory.encoders.size(), trajectory.joint_observations.samples.size());
      std::size_t c = 0;
      for (const StampedJoints& sample : trajectory.joint_observations.samples) {
        while (c + 1 < trajectory.commands.size() &&
               trajectory.commands[c + 1].stamp <= sample.stamp)
          ++c;
        if (sample.stamp - trajectory.commands[c].stamp < kSettled) continue;
        largest = std::max(largest, std::abs(sample.positions(1) -
                                             trajectory.joint_commands.samples[c].positions(1)));
      }
    }
    return largest;
  };
  EXPECT_LT(largestAway(recordOne("backlash", {1}, {{"w", 0.03}}, 6, true)), 1e-4);
  EXPECT_LT(largestAway(recordOne("joint_offset", {1}, {{"d", 0.03}}, 6, true)), 1e-4);
  EXPECT_NEAR(largestAway(recordOne("drive_friction", {1}, {{"w", 0.03}}, 6, true)), 0.015, 1e-3);
  EXPECT_TRUE(
      recordOne("backlash", {1}, {{"w", 0.03}}, 1).dataset.trajectories[0].encoders.empty());
}

// --- drawing
// --------------------------------------------------------------------------------------

TEST(PlantDraw, ReachesTheSizeThatWasAskedFor) {
  const PlantOptions options = quiet(6);
  for (const std::string& effect : hiddenEffects()) {
    const HiddenEffect hidden = drawHidden(options, effect, 11, 8.0, 8.0001);
    const PlantSession session = recordHidden(options, {hidden});
    const HiddenEffect& truth = session.truth.front();
    const double multiples = multiplesOfNoise({truth.size_mm, truth.size_deg});
    EXPECT_GT(multiples, 7.0) << describe(truth);
    EXPECT_LT(multiples, 9.0) << describe(truth);
  }
}

TEST(PlantDraw, SetsAreOfDifferentEffectsAndSeedsDiffer) {
  const PlantOptions options = quiet(4);
  const std::vector<HiddenEffect> three = drawHiddenSet(options, 3, 3, 5.0, 20.0);
  ASSERT_EQ(three.size(), 3u);
  EXPECT_NE(three[0].effect, three[1].effect);
  EXPECT_NE(three[0].effect, three[2].effect);
  EXPECT_NE(three[1].effect, three[2].effect);
  const PlantSession session = recordHidden(options, three);
  EXPECT_EQ(session.truth.size(), 3u);
  for (const HiddenEffect& effect : session.truth)
    EXPECT_GT(multiplesOfNoise({effect.size_mm, effect.size_deg}), 2.0) << describe(effect);
  std::set<int> drawn;
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    drawn.insert(drawHidden(options, "joint_offset", seed, 5.0, 20.0).joints[0]);
  EXPECT_GE(drawn.size(), 3u);
}

TEST(PlantDraw, RefusesWhatItCannotHide) {
  const PlantOptions options = quiet(1);
  const auto record = [&](const HiddenEffect& effect) { recordHidden(options, {effect}); };
  EXPECT_THROW(record({"rust", {1}, {{"w", 0.1}}, 0.0, 0.0}), InvalidInput);
  EXPECT_THROW(record({"backlash", {}, {{"w", 0.1}}, 0.0, 0.0}), InvalidInput);
  EXPECT_THROW(record({"backlash", {6}, {{"w", 0.1}}, 0.0, 0.0}), InvalidInput);
  EXPECT_THROW(record({"backlash", {1}, {}, 0.0, 0.0}), InvalidInput);
  EXPECT_THROW(record({"backlash", {1}, {{"w", 0.1}, {"d", 0.1}}, 0.0, 0.0}), InvalidInput);
  EXPECT_THROW(record({"backlash", {1}, {{"w", std::nan("")}}, 0.0, 0.0}), InvalidInput);
  EXPECT_THROW(record({"joint_coupling", {1, 1}, {{"c", 0.1}}, 0.0, 0.0}), InvalidInput);
  PlantOptions none = options;
  none.trajectories = 0;
  EXPECT_THROW(recordClean(none), InvalidInput);
}

TEST(PlantOutside, EveryKindReachesItsSize) {
  const PlantOptions options = quiet(8);
  EXPECT_GE(std::count_if(outsideKinds().begin(), outsideKinds().end(),
                          [](OutsideKind kind) { return !isNearCatalogue(kind); }),
            5);
  for (const OutsideKind kind : outsideKinds()) {
    const PlantSession session = recordOutside(options, kind, 10.0, 4);
    EXPECT_TRUE(session.truth.empty());
    EXPECT_EQ(session.outside.rfind(toString(kind), 0), 0u);
    const double multiples = multiplesOfNoise({session.outside_size_mm, session.outside_size_deg});
    EXPECT_GT(multiples, 8.0) << session.outside;
    EXPECT_LT(multiples, 12.5) << session.outside;
  }
}

}  // namespace
}  // namespace raven_correction::plant
