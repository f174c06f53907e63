// SPDX-License-Identifier: BSD-3-Clause
// Each effect against what its equation says it does.
#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/robot/gravity_load.h"
#include "raven_correction/simulation/simulated_arm.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

/// A stage driven directly: one joint takes a sequence of set-points, the others stay at home.
class Stage {
 public:
  Stage(const std::string& name, std::initializer_list<std::pair<const char*, double>> values)
      : robot_(shippedSimulation("nominal").robot),
        effect_(effectWith(name, robot_, values)),
        memory_(robot_.home()),
        load_(JointVector::Zero(6)),
        motor_travel_(shippedSimulation("nominal").coupling.motorTravel(robot_)) {}

  const KinematicChain& robot() const { return robot_; }
  void setLoad(const JointVector& load) { load_ = load; }
  JointVector apply(JointVector q, double step, double time = 0.0) {
    effect_->apply({time, step, robot_.home(), load_, &motor_travel_}, memory_, q);
    return q;
  }
  /// Displacement from home of one joint, driven to `displacement`.
  double drive(const char* joint, double displacement, double step = 1e-3, double time = 0.0) {
    const int j = robot_.indexOf(joint);
    const JointVector q = robot_.home() + displacement * JointVector::Unit(6, j);
    return apply(q, step, time)(j) - robot_.home()(j);
  }

 private:
  KinematicChain robot_;
  std::unique_ptr<Effect> effect_;
  JointVector memory_;
  JointVector load_;
  JointMatrix motor_travel_;
};

// Up to 0.1 and back to -0.1 with play of full width 0.02: lags by 0.01 each way, and the turn
// takes 0.02. Expected values are exact up to rounding, for fine and coarse steps alike.
void expectPlay(const std::string& name) {
  for (const int steps : {1, 7, 1000}) {
    Stage stage(name, {{"w[elbow]", 0.02}});
    double q = 0.0;
    for (int k = 1; k <= steps; ++k) q = stage.drive("elbow", 0.1 * k / steps);
    EXPECT_NEAR(q, 0.09, 1e-14);
    EXPECT_NEAR(stage.drive("elbow", 0.085), 0.09, 1e-14) << "inside the play nothing moves";
    EXPECT_NEAR(stage.drive("elbow", 0.08), 0.09, 1e-14);
    EXPECT_NEAR(stage.drive("elbow", 0.07), 0.08, 1e-14);
    for (int k = 1; k <= steps; ++k) q = stage.drive("elbow", 0.07 - 0.17 * k / steps);
    EXPECT_NEAR(q, -0.09, 1e-14);
  }
}

TEST(Effects, DriveFrictionIsPlay) { expectPlay("drive_friction"); }
TEST(Effects, BacklashIsPlay) { expectPlay("backlash"); }

TEST(Effects, EncodersSeeFrictionButNotBacklash) {
  for (const char* name : {"drive_friction", "backlash"}) {
    SimulationConfig config = simulationWith(name, {{"w[insertion]", 0.01}});
    SimulatedArm arm(config, 0.0);
    const Pose home = arm.toolPose();
    const JointVector q_home = config.robot.home();
    JointVector q = q_home;
    const int insertion = config.robot.indexOf("insertion");
    q(insertion) -= 0.05;
    arm.command({0.1, config.robot.forward(q)});
    arm.advanceTo(0.2);
    EXPECT_NEAR(arm.joints()(insertion), q(insertion) + 0.005, 1e-9);
    const bool seen = std::string(name) == "drive_friction";
    EXPECT_NEAR(arm.motorJoints()(insertion), q(insertion) + (seen ? 0.005 : 0.0), 1e-9);
    EXPECT_NEAR((arm.toolPose().p - home.p).norm(), 0.045, 1e-9);
  }
}

TEST(Effects, TrackingLagIsExponential) {
  for (const double step : {1e-3, 0.013, 0.4}) {
    Stage stage("tracking_lag", {{"T[shoulder]", 0.2}});
    double q = 0.0;
    for (double t = step; t < 0.4 + 0.5 * step; t += step) {
      q = stage.drive("shoulder", 1.0, step);
      EXPECT_NEAR(q, 1.0 - std::exp(-t / 0.2), 1e-12);
    }
  }
}

TEST(Effects, SpeedLimitIsAStraightLine) {
  Stage stage("speed_limit", {{"v[insertion]", 0.05}});
  for (int k = 1; k <= 20; ++k)
    EXPECT_NEAR(stage.drive("insertion", 0.01, 0.02), std::min(0.01, 0.001 * k), 1e-14);
  EXPECT_NEAR(stage.drive("insertion", 0.0, 0.02), 0.009, 1e-14);
}

// Full speed until the rest of the way takes T, then the exponential of the lag: exact for any
// step. The one becomes the other at 1.9008 s, within a step.
TEST(Effects, MotorSaturationIsALineAndThenALag) {
  for (const double step : {1e-3, 0.07, 0.3}) {
    Stage stage("motor_saturation", {{"T[shoulder]", 0.1}, {"v[shoulder]", 0.5}});
    for (double t = step; t < 3.0; t += step) {
      const double expected = t < 1.9008 ? 0.5 * t : 1.0004 - 0.05 * std::exp(-(t - 1.9008) / 0.1);
      EXPECT_NEAR(stage.drive("shoulder", 1.0004, step), expected, 1e-12) << t;
    }
  }
  Stage lag("motor_saturation", {{"T[shoulder]", 0.2}});
  EXPECT_NEAR(lag.drive("shoulder", 1.0, 0.3), 1.0 - std::exp(-1.5), 1e-14);
}

// Load helps the motor one way and hinders it the other way; a load above v stalls it.
TEST(Effects, MotorSaturationDependsOnLoad) {
  const auto stage = [](double load_per_shoulder) {
    return Stage("motor_saturation",
                 {{"v[elbow]", 0.5}, {"l[elbow]", 0.2}, {"f[elbow<-shoulder]", load_per_shoulder}});
  };
  EXPECT_NEAR(stage(0.0).drive("elbow", 1.0, 0.1), 0.07, 1e-14);
  EXPECT_NEAR(stage(0.0).drive("elbow", -1.0, 0.1), -0.03, 1e-14);
  Stage away = stage(2.0);
  const JointVector q =
      away.robot().home() + 0.05 * JointVector::Unit(6, 0) + JointVector::Unit(6, 1);
  EXPECT_NEAR(away.apply(q, 0.1)(1) - away.robot().home()(1), 0.08 - 0.145567 * 0.05, 1e-9);
  Stage stalled = stage(-20.0);
  EXPECT_NEAR(stalled.apply(q, 0.1)(1) - stalled.robot().home()(1), -0.145567 * 0.05, 1e-9)
      << "a motor that stands still lets the joint be dragged";
}

// 0.1 m/s of insertion take 13.8 rad/s of the roll motor. At 5 rad/s the tool is dragged along by
// the rest; when the insertion stops it comes back at 5 rad/s. With a lag alone it is behind by its
// T.
TEST(Effects, MotorSaturationDragsTheRoll) {
  constexpr double kTravel = 138.196;  // rad of roll per metre of insertion, published
  for (const double step : {1e-3, 0.02}) {
    Stage stage("motor_saturation", {{"v[tool_roll]", 5.0}});
    const KinematicChain& robot = stage.robot();
    const int roll = robot.indexOf("tool_roll");
    const int insertion = robot.indexOf("insertion");
    JointVector q = robot.home();
    JointVector moved = q;
    for (int k = 1; k <= std::lround(0.2 / step); ++k) {
      q(insertion) = robot.home()(insertion) - 0.1 * step * k;
      moved = stage.apply(q, step);
    }
    const double dragged = (0.1 * kTravel - 5.0) * 0.2;
    EXPECT_NEAR(moved(roll), dragged, 1e-5);
    EXPECT_NEAR(moved(insertion), q(insertion), 1e-15);
    for (int k = 1; k <= std::lround(0.1 / step); ++k) moved = stage.apply(q, step);
    EXPECT_NEAR(moved(roll), dragged - 0.5, 1e-5);
    for (int k = 1; k <= std::lround(0.4 / step); ++k) moved = stage.apply(q, step);
    EXPECT_NEAR(moved(roll), 0.0, 1e-12);
  }
  Stage lag("motor_saturation", {{"T[tool_roll]", 0.02}});
  JointVector q = lag.robot().home();
  JointVector moved = q;
  for (int k = 1; k <= 300; ++k) {
    q(3) -= 0.1 * 1e-3;
    moved = lag.apply(q, 1e-3);
  }
  EXPECT_NEAR(moved(2), 0.1 * kTravel * 0.02, 0.1 * kTravel * 0.5e-3);  // half a step of 1 ms
}

// In the arm: encoders and tool both see it, and the robot's file says which cables are coupled.
// The goal moves evenly, so one step is as good as a thousand: from the lag to the limit, and back
// across to the other limit.
TEST(Effects, MotorSaturationOfAMovingGoalDoesNotDependOnTheStep) {
  const auto roll = [](double T, int parts) {
    Stage stage("motor_saturation", {{"T[tool_roll]", T}, {"v[tool_roll]", 5.0}});
    const int j = stage.robot().indexOf("tool_roll"), k = stage.robot().indexOf("insertion");
    JointVector q = stage.robot().home();
    std::vector<double> ends;
    for (const double speed : {-0.1, 0.1, 0.02}) {
      JointVector moved = q;
      for (int i = 0; i < parts; ++i) {
        q(k) += speed * 0.3 / parts;
        moved = stage.apply(q, 0.3 / parts);
      }
      ends.push_back(moved(j) - stage.robot().home()(j));
    }
    return ends;
  };
  for (const double T : {0.0, 0.05, 0.4}) {
    const std::vector<double> one = roll(T, 1), many = roll(T, 1000);
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_NEAR(one[i], many[i], 1e-9) << "T = " << T << ", stretch " << i;
      EXPECT_GT(std::abs(many[i]), 0.01) << "nothing lags, nothing is tested";
    }
  }
}

// A set-point may jump in a step of next to no time: the motor has not moved, so the roll turns by
// all that the insertion's cable has moved.
TEST(Effects, MotorSaturationKeepsItsDigitsInAShortStep) {
  Stage stage("motor_saturation", {{"T[tool_roll]", 0.1}});
  const int j = stage.robot().indexOf("tool_roll"), k = stage.robot().indexOf("insertion");
  const JointVector q = stage.robot().home() + 1e-3 * JointVector::Unit(6, k);
  const JointVector short_step = stage.apply(q, 2e-16);
  Stage other("motor_saturation", {{"T[tool_roll]", 0.1}});
  const JointVector longer_step = other.apply(q, 1e-9);
  EXPECT_NEAR(short_step(j), longer_step(j), 1e-6);
  EXPECT_GT(std::abs(short_step(j) - stage.robot().home()(j)), 0.05);
}

TEST(Effects, EncodersSeeMotorSaturation) {
  SimulationConfig config = simulationWith("motor_saturation", {{"v[tool_roll]", 5.0}});
  for (const bool coupled : {true, false}) {
    if (!coupled) config.coupling = CableCoupling();
    SimulatedArm arm(config, 0.0);
    JointVector q = config.robot.home();
    for (int k = 1; k <= 50; ++k) {
      q(3) -= 0.002;
      arm.command({0.02 * k, config.robot.forward(q)});
    }
    arm.advanceTo(0.5);
    const double roll = arm.motorJoints()(2);
    if (coupled)
      EXPECT_GT(roll, 1.0);
    else
      EXPECT_NEAR(roll, 0.0, 1e-9);
    EXPECT_EQ(arm.joints()(2), roll);
  }
}

TEST(Effects, CommandDelayShiftsTime) {
  const SimulationConfig delayed = simulationWith("command_delay", {{"tau", 0.1234}});
  const SimulationConfig nominal = shippedSimulation("nominal");
  DebridementMotion motion(nominal.debridement, nominal.robot, 3);
  SimulatedArm late(delayed, 0.0);
  SimulatedArm now(nominal, 0.0);
  for (const StampedPose& command : motion.next(0.5).commands) {
    late.command(command);
    now.command(command);
  }
  for (double t = 0.1; t < 2.0; t += 0.00971) {
    now.advanceTo(t);
    late.advanceTo(t + 0.1234);
    // A command that acts within rounding of t may be on either side of it.
    EXPECT_LT((late.joints() - now.joints()).cwiseAbs().maxCoeff(), 1e-12) << t;
  }
}

TEST(Effects, JointGainIsProportional) {
  Stage stage("joint_gain", {{"g[wrist_pitch]", -0.08}});
  EXPECT_NEAR(stage.drive("wrist_pitch", 0.5), 0.46, 1e-15);
  EXPECT_EQ(stage.drive("wrist_pitch", 0.0), 0.0);
  EXPECT_NEAR(stage.drive("elbow", 0.5), 0.5, 1e-15);
}

TEST(Effects, JointCouplingMovesTheOtherJoint) {
  Stage stage("joint_coupling", {{"c[elbow<-shoulder]", 0.1}, {"c[wrist_yaw<-insertion]", -20.0}});
  const KinematicChain& robot = stage.robot();
  JointVector q = robot.home();
  q(robot.indexOf("shoulder")) += 0.3;
  q(robot.indexOf("insertion")) -= 0.01;
  const JointVector moved = stage.apply(q, 1e-3) - q;
  for (int j = 0; j < 6; ++j) {
    double expected = 0.0;
    if (j == robot.indexOf("elbow")) expected = 0.03;
    if (j == robot.indexOf("wrist_yaw")) expected = 0.2;
    EXPECT_NEAR(moved(j), expected, 1e-14) << robot.joints()[static_cast<std::size_t>(j)].name;
  }
}

// Two joints coupled to one another: both take the input of the other, not its output.
TEST(Effects, JointCouplingIsSimultaneous) {
  Stage stage("joint_coupling", {{"c[elbow<-shoulder]", 0.5}, {"c[shoulder<-elbow]", 0.5}});
  const JointVector q =
      stage.robot().home() + 0.2 * JointVector::Unit(6, 0) + 0.1 * JointVector::Unit(6, 1);
  const JointVector moved = stage.apply(q, 1e-3) - q;
  EXPECT_NEAR(moved(0), 0.05, 1e-15);
  EXPECT_NEAR(moved(1), 0.1, 1e-15);
}

TEST(Effects, PulleyEccentricityIsASine) {
  Stage stage("pulley_eccentricity",
              {{"A[tool_roll]", 0.02}, {"N[tool_roll]", 5.0}, {"phi[tool_roll]", 0.3}});
  for (const double q : {-1.0, 0.0, 0.4, 2.0})
    EXPECT_NEAR(stage.drive("tool_roll", q), q + 0.02 * std::sin(5.0 * q + 0.3), 1e-15);
}

TEST(Effects, CableStretchFollowsTheLoad) {
  Stage stage("cable_stretch", {{"s[elbow]", 0.01}, {"s[insertion]", 0.0005}});
  JointVector load = JointVector::Zero(6);
  load(stage.robot().indexOf("elbow")) = -2.0;
  load(stage.robot().indexOf("insertion")) = 3.0;
  stage.setLoad(load);
  EXPECT_NEAR(stage.drive("elbow", 0.1), 0.08, 1e-15);
  EXPECT_NEAR(stage.drive("insertion", 0.0), 0.0015, 1e-15);
}

// In the arm: the load is gravity, and a payload pulls further in the same direction.
TEST(Effects, PayloadStretchesTheCable) {
  SimulationConfig config = simulationWith("cable_stretch", {{"s[insertion]", 0.001}});
  config.gripper.payload = 0.2;
  SimulatedArm arm(config, 0.0);
  const int insertion = config.robot.indexOf("insertion");
  arm.advanceTo(0.1);
  const double empty = arm.joints()(insertion);
  const JointVector load = gravityLoad(config.robot, arm.joints(), 0.0);
  EXPECT_NEAR(empty - config.robot.home()(insertion), 0.001 * load(insertion), 1e-12);
  ASSERT_TRUE(arm.commandJaw(0.1, 0.5));
  arm.advanceTo(0.5);
  EXPECT_NEAR(arm.joints()(insertion), empty, 1e-12) << "a jaw that is open holds nothing";
  ASSERT_TRUE(arm.commandJaw(0.5, 0.0));
  arm.advanceTo(1.0);
  const double pull = gravityLoad(config.robot, arm.joints(), 0.2)(insertion) - load(insertion);
  EXPECT_NEAR(arm.joints()(insertion) - empty, 0.001 * pull, 1e-9);
  EXPECT_GT(std::abs(pull), 1.0);
  ASSERT_TRUE(arm.commandJaw(1.0, 0.5));
  arm.advanceTo(1.5);
  EXPECT_NEAR(arm.joints()(insertion), empty, 1e-9) << "let go of";
}

TEST(Effects, CreepApproachesItsEnd) {
  Stage stage("creep", {{"a[elbow]", 0.03}, {"T[elbow]", 100.0}, {"a[shoulder]", 0.01}});
  for (const double t : {0.0, 1.0, 100.0, 1e4})
    EXPECT_NEAR(stage.drive("elbow", 0.0, 1e-3, t), 0.03 * (1.0 - std::exp(-t / 100.0)), 1e-15);
  EXPECT_NEAR(stage.drive("shoulder", 0.0, 1e-3, 0.0), 0.01, 1e-15) << "T = 0: at once";
}

TEST(Effects, JointOffsetIsConstant) {
  Stage stage("joint_offset", {{"d[insertion]", -0.004}});
  EXPECT_NEAR(stage.drive("insertion", 0.02), 0.016, 1e-15);
}

TEST(Effects, LinkGeometryChangesTheChain) {
  const SimulationConfig config = simulationWith(
      "link_geometry", {{"alpha[elbow]", 0.01}, {"a[wrist_yaw]", 0.002}, {"d[insertion]", 0.003}});
  std::vector<Joint> joints = config.robot.joints();
  joints[1].alpha += 0.01;
  joints[5].a += 0.002;
  joints[3].d_offset += 0.003;
  const KinematicChain expected("x", "x", config.robot.baseTransform(), joints,
                                config.robot.toolTransform());
  const SimulatedArm arm(config, 0.0);
  EXPECT_LT((arm.toolPose().p - expected.forward(config.robot.home()).p).norm(), 1e-15);
  EXPECT_GT((arm.toolPose().p - arm.measuredPose().p).norm(), 1e-3);
}

TEST(Effects, RegistrationToolAndScaleAreWhatTheySay) {
  const Pose nominal = SimulatedArm(shippedSimulation("nominal"), 0.0).toolPose();
  const Pose X_error{{0.01, -0.02, 0.03}, expRotation({0.1, 0.2, -0.3})};
  const std::initializer_list<std::pair<const char*, double>> values{
      {"x", 0.01}, {"y", -0.02}, {"z", 0.03}, {"rx", 0.1}, {"ry", 0.2}, {"rz", -0.3}};
  const auto expectPose = [](const Pose& a, const Pose& b) {
    EXPECT_LT((a.p - b.p).norm(), 1e-15);
    EXPECT_LT(rotationAngle(a.q, b.q), 1e-14);
  };
  expectPose(SimulatedArm(simulationWith("base_registration", values), 0.0).toolPose(),
             X_error * nominal);
  expectPose(SimulatedArm(simulationWith("tool_offset", values), 0.0).toolPose(),
             nominal * X_error);
  Pose scaled = nominal;
  scaled.p *= 1.02;
  expectPose(SimulatedArm(simulationWith("mocap_scale", {{"s", 0.02}}), 0.0).toolPose(), scaled);

  SimulationConfig config = simulationWith("registration_shift", values);
  std::unique_ptr<Effect> shift = config.find("registration_shift")->clone();
  shift->setValue(0, 2.0);
  config.set(std::move(shift));
  SimulatedArm arm(config, 10.0);
  arm.advanceTo(11.99);
  expectPose(arm.toolPose(), nominal);
  arm.advanceTo(12.01);
  expectPose(arm.toolPose(), X_error * nominal);
}

}  // namespace
}  // namespace raven_correction
