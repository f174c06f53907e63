// SPDX-License-Identifier: BSD-3-Clause
// The parts of the diagnosis on data whose answer is known: cleaning of recordings, residuals,
// fits, comparisons, joint data.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "diagnosis/fixtures.h"
#include "diagnosis/judge.h"
#include "plant/joint_session.h"
#include "raven_correction/diagnosis/noise_floor.h"
#include "raven_correction/error.h"
#include "raven_correction/report/diagnosis_report.h"
#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

SimulationConfig with(const std::string& effect, int index, double value) {
  return withValues(nominal(), {{effect, index}}, Eigen::VectorXd::Constant(1, value));
}

Dataset recorded(const SimulationConfig& simulation) { return simulateSession(simulation, 10, 5); }

TEST(Recording, LeavesOutWhatCannotBeReal) {
  Dataset dataset = recorded(nominal());
  Trajectory& trajectory = dataset.trajectories[3];
  trajectory.commands[4].pose = Pose();
  trajectory.observations[5].pose.p.x() = std::nan("");
  trajectory.observations[9].pose.q =
      trajectory.observations[9].pose.q * expRotation(Eigen::Vector3d(2.0, 0.0, 0.0));
  trajectory.observations[12].pose = trajectory.observations[11].pose;
  trajectory.observations[12].stamp = trajectory.observations[11].stamp;
  RecordingOptions options;
  options.max_samples = 0;
  const Recording clean = makeRecording(recorded(nominal()), nominal().robot, options);
  const Recording recording = makeRecording(dataset, nominal().robot, options);
  EXPECT_EQ(recording.left_out.not_a_command, clean.left_out.not_a_command + 1);
  EXPECT_EQ(recording.left_out.impossible, clean.left_out.impossible + 2);
  EXPECT_EQ(recording.left_out.repeated, clean.left_out.repeated + 1);
}

// However few observations are wanted: every motion keeps one.
TEST(Recording, ThinsWithoutLosingMotions) {
  RecordingOptions options;
  options.max_samples = 3;
  const Recording recording = makeRecording(recorded(nominal()), nominal().robot, options);
  EXPECT_EQ(recording.motions.size(), 10u);
  for (const Recording::Motion& motion : recording.motions)
    EXPECT_FALSE(motion.observations.empty());
  EXPECT_EQ(residuals(recording, residualLayout(recording), nominal()).hasNaN(), false);
}

TEST(Recording, RefusesAnotherFrameAndOutOfReach) {
  Dataset dataset = recorded(nominal());
  dataset.frame = "camera";
  EXPECT_THROW(makeRecording(dataset, nominal().robot, {}), InvalidInput);
  dataset = recorded(nominal());
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& command : trajectory.commands) command.pose.p *= 1000.0;  // millimetres
  EXPECT_THROW(makeRecording(dataset, nominal().robot, {}), InvalidInput);
}

// Creep of a day, and a homing and a registration for two days: no single simulation is of both.
TEST(Recording, RefusesSeveralSessions) {
  constexpr double kDay = 86400.0;
  Dataset dataset = recorded(nominal());
  dataset.source = "two.bag";
  const auto shift = [&](std::size_t from, double seconds) {
    for (std::size_t i = from; i < dataset.trajectories.size(); ++i) {
      for (PoseStream* stream :
           {&dataset.trajectories[i].commands, &dataset.trajectories[i].observations,
            &dataset.trajectories[i].encoders})
        for (StampedPose& sample : *stream) sample.stamp += seconds;
      for (StampedJoints& sample : dataset.trajectories[i].joint_observations.samples)
        sample.stamp += seconds;
    }
  };
  shift(6, 0.5 * kLongestPause);
  EXPECT_EQ(sessionStarts(dataset), std::vector<std::size_t>{0});
  EXPECT_NO_THROW(makeRecording(dataset, nominal().robot, {}));
  shift(7, kDay);
  EXPECT_EQ(sessionStarts(dataset), (std::vector<std::size_t>{0, 7}));
  try {
    makeRecording(dataset, nominal().robot, {});
    FAIL();
  } catch (const InvalidInput& error) {
    const std::string why = error.what();
    EXPECT_NE(why.find("two.bag: 2 sessions"), std::string::npos) << why;
    EXPECT_NE(why.find("trajectory " + dataset.trajectories[7].id), std::string::npos) << why;
    EXPECT_NE(why.find("each on its own"), std::string::npos) << why;
  }
}

// The simulation that made the recording explains it to the noise of the cameras.
TEST(Residual, OfTheTruthIsNoise) {
  const SimulationConfig truth = with("joint_offset", 1, 0.02);
  const Recording recording = makeRecording(recorded(truth), nominal().robot, {});
  const ResidualLayout layout = residualLayout(recording);
  const double wrong = errorSizes(layout, residuals(recording, layout, nominal())).position_median;
  const double right = errorSizes(layout, residuals(recording, layout, truth)).position_median;
  EXPECT_GT(wrong, 1e-3);
  EXPECT_LT(right, 3e-4);
}

TEST(EffectFit, FindsTheValueAndItsDeviation) {
  int covered = 0;
  const int seeds = 12;
  for (int seed = 0; seed < seeds; ++seed) {
    const SimulationConfig truth = with("joint_gain", 0, 0.03);
    const Dataset dataset = simulateSession(truth, 10, 100 + static_cast<std::uint64_t>(seed));
    RecordingOptions options;
    options.use_encoders = false;
    options.max_samples = 1500;
    const Recording recording = makeRecording(dataset, nominal().robot, options);
    const ResidualLayout layout = residualLayout(recording);
    EffectFitProblem problem;
    problem.recording = &recording;
    problem.layout = &layout;
    problem.simulation = nominal();
    problem.parameters = {{"joint_gain", 0}};
    problem.start = Eigen::VectorXd::Zero(1);
    problem.scales = channelScales(layout, residuals(recording, layout, nominal()));
    const EffectFit fit = fitEffects(problem);
    EXPECT_TRUE(fit.converged) << fit.message;
    EXPECT_NEAR(fit.values(0), 0.03, 5e-4);
    const double deviation = std::sqrt(fit.covariance(0, 0));
    EXPECT_LT(deviation, 5e-4);
    covered += std::abs(fit.values(0) - 0.03) <= 2.5 * deviation;
  }
  EXPECT_GE(covered, seeds - 3);
}

TEST(LossComparison, SeesAGainAndNotNoise) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0.0, 0.1);
  Eigen::VectorXd before(200), worse(200), better(200);
  for (int m = 0; m < 200; ++m) {
    before(m) = 1.0 + noise(engine);
    worse(m) = before(m) + noise(engine);
    better(m) = 0.8 * before(m);
  }
  const LossComparison none = compareLosses(before, worse, 1);
  EXPECT_LT(none.lower, 0.0);
  EXPECT_GT(none.upper, none.lower);
  EXPECT_LT(none.z_mean, 4.0);
  const LossComparison gain = compareLosses(before, better, 1);
  EXPECT_NEAR(gain.share, 0.2, 1e-9);
  EXPECT_GT(gain.z_mean, 20.0);
}

TEST(NoiseFloor, IsThatOfTheCameras) {
  const Recording recording = makeRecording(recorded(nominal()), nominal().robot, {});
  const ResidualLayout layout = residualLayout(recording);
  const Eigen::VectorXd residual = residuals(recording, layout, nominal());
  const Eigen::VectorXd floor = noiseFloor(recording, nominal());
  const Eigen::VectorXd scale = channelScales(layout, residual);
  EXPECT_NEAR(floor(0), scale(0), 0.15 * scale(0));
  EXPECT_NEAR(floor(1), scale(1), 0.15 * scale(1));
}

// What is used of the recording does not change its noise: every tenth observation, of a robot
// whose error is no noise, has the floor of all of them.
TEST(NoiseFloor, DoesNotDependOnHowManySamplesAreUsed) {
  const Dataset dataset = recorded(with("command_delay", 0, 0.1));
  RecordingOptions options;
  options.max_samples = 0;
  const Recording all = makeRecording(dataset, nominal().robot, options);
  std::size_t count = 0;
  for (const Recording::Motion& motion : all.motions) count += motion.observations.size();
  options.max_samples = count / 10;
  const Recording few = makeRecording(dataset, nominal().robot, options);
  const Eigen::VectorXd floor = noiseFloor(all, nominal());
  EXPECT_LT((noiseFloor(few, nominal()) - floor).cwiseAbs().maxCoeff(), 1e-12);
  // And that of the cameras, though the simulation is wrong by far more.
  const Eigen::VectorXd right = noiseFloor(all, with("command_delay", 0, 0.1));
  EXPECT_NEAR(floor(0), right(0), 0.1 * right(0));
  EXPECT_NEAR(floor(1), right(1), 0.1 * right(1));
}

// Encoders that are rarer than the cameras, in short motions: fewer of them are used than there are
// motions, and still they are a part of the recording.
TEST(Recording, SparseEncodersOutliveThinning) {
  Dataset dataset = recorded(nominal());
  std::size_t encoders = 0, total = 0;
  for (Trajectory& trajectory : dataset.trajectories) {
    JointStream rare;
    rare.names = nominal().robot.jointNames();
    for (std::size_t i = 0; i < trajectory.commands.size(); i += 20) {
      JointVector joints = nominal().robot.home();
      joints(0) += 1e-4 * static_cast<double>(i);  // the same again would count as repeated
      rare.samples.push_back({trajectory.commands[i].stamp, joints});
    }
    encoders += rare.samples.size();
    trajectory.joint_observations = rare;
    total += rare.samples.size() + trajectory.observations.size();
  }
  RecordingOptions options;
  options.max_samples = total * dataset.trajectories.size() / 2 / encoders;
  const Recording recording = makeRecording(dataset, nominal().robot, options);
  EXPECT_TRUE(recording.has_encoders);
  std::size_t kept = 0;
  for (const Recording::Motion& motion : recording.motions)
    for (const Recording::Observation& observation : motion.observations)
      kept += observation.kind == Recording::Observation::Kind::kEncoders;
  EXPECT_GE(kept, recording.motions.size() / 2);  // as many as were asked for
  EXPECT_LE(kept, recording.motions.size());
  const ResidualLayout layout = residualLayout(recording);
  EXPECT_EQ(layout.channels.size(), 2u + nominal().robot.jointNames().size());
  EXPECT_EQ(noiseFloor(recording, nominal()).size(),
            static_cast<Eigen::Index>(layout.channels.size()));
}

TEST(EffectFit, WhatMovesNothingIsUnknownWithinItsRange) {
  Dataset dataset = recorded(nominal());
  const Recording recording = makeRecording(dataset, nominal().robot, {});
  const ResidualLayout layout = residualLayout(recording);
  EffectFitProblem problem;
  problem.recording = &recording;
  problem.layout = &layout;
  problem.simulation = nominal();
  problem.parameters = {{"joint_offset", 0}, {"joint_gain", 0}};
  EffectFit fit;
  fit.values = Eigen::VectorXd::Zero(2);
  fit.residual = residuals(recording, layout, nominal());
  fit.jacobian =
      residualJacobian(recording, layout, nominal(), problem.parameters, fit.values, fit.residual);
  fit.jacobian.col(1).setZero();
  const Eigen::MatrixXd covariance = effectCovariance(problem, fit);
  const EffectParameter gain = parameterOf(nominal(), problem.parameters[1]);
  EXPECT_NEAR(std::sqrt(covariance(1, 1)), gain.upper - gain.lower, 1e-6);
  const EffectParameter offset = parameterOf(nominal(), problem.parameters[0]);
  EXPECT_LT(std::sqrt(covariance(0, 0)), 0.1 * (offset.upper - offset.lower));
}

// What only moves the tool or what is seen of it needs no second run of the joints.
TEST(Residual, OfTheSameJointsIsThatOfTheWholeSimulation) {
  const Recording recording =
      makeRecording(simulateSession(with("backlash", 1, 0.02), 10, 5), nominal().robot, {});
  const ResidualLayout layout = residualLayout(recording);
  const SimulationConfig here = with("joint_coupling", 3, 0.1);
  SimulatedSamples simulated;
  const Eigen::VectorXd residual = residuals(recording, layout, here, &simulated);
  std::set<std::string> alone;
  for (const Hypothesis& hypothesis : allHypotheses(recording, nominal())) {
    if (!leavesJointsAlone(here, hypothesis.effect)) continue;
    alone.insert(hypothesis.effect);
    Eigen::VectorXd values(static_cast<Eigen::Index>(hypothesis.parameters.size()));
    for (Eigen::Index i = 0; i < values.size(); ++i)
      values(i) = 0.1 * parameterOf(here, hypothesis.parameters[static_cast<std::size_t>(i)]).upper;
    const SimulationConfig there = withValues(here, hypothesis.parameters, values);
    const Eigen::VectorXd whole = residuals(recording, layout, there);
    if (hypothesis.parameters.size() == 6) {  // angles of links only show where joints follow
      EXPECT_GT((whole - residual).norm(), 1e-6) << hypothesis.effect;
    }
    EXPECT_EQ(residualsOfJoints(recording, there, simulated, residual), whole) << hypothesis.effect;
  }
  EXPECT_EQ(alone, (std::set<std::string>{"base_registration", "link_geometry", "mocap_scale",
                                          "registration_shift", "tool_offset"}));
  // The load of stretching cables depends on the links.
  const SimulationConfig loaded = with("cable_stretch", 0, 1e-3);
  EXPECT_FALSE(leavesJointsAlone(loaded, "link_geometry"));
  EXPECT_TRUE(leavesJointsAlone(loaded, "mocap_scale"));
}

// Running every effect through the whole recording is what running the arm step by step is; a load
// without any effect takes the second way.
TEST(Residual, EffectByEffectIsThatOfTheArmStepByStep) {
  const Recording recording =
      makeRecording(simulateSession(with("backlash", 1, 0.02), 10, 5), nominal().robot, {});
  const ResidualLayout layout = residualLayout(recording);
  std::set<std::string> effects;
  const SimulationConfig here =
      withValues(nominal(), {{"backlash", 2}, {"joint_coupling", 3}, {"tracking_lag", 1}},
                 Eigen::Vector3d(1e-3, 0.1, 0.02));
  for (const Hypothesis& hypothesis : allHypotheses(recording, nominal())) {
    if (hypothesis.effect == "cable_stretch") continue;
    effects.insert(hypothesis.effect);
    Eigen::VectorXd values(static_cast<Eigen::Index>(hypothesis.parameters.size()));
    for (Eigen::Index i = 0; i < values.size(); ++i)
      values(i) = 0.1 * parameterOf(here, hypothesis.parameters[static_cast<std::size_t>(i)]).upper;
    for (const SetpointMode mode : {SetpointMode::kHold, SetpointMode::kLinear}) {
      SimulationConfig there = withValues(here, hypothesis.parameters, values);
      there.setpoints = mode;
      const SimulationConfig loaded =
          withValues(there, {{"cable_stretch", 0}}, Eigen::VectorXd::Constant(1, 1e-300));
      EXPECT_EQ(residuals(recording, layout, there), residuals(recording, layout, loaded))
          << hypothesis.effect;
    }
  }
  EXPECT_GE(effects.size(), 14u);
}

// An effect that remembers and does not say so would be run where it is seen only.
TEST(Effects, SayWhetherTheyRemember) {
  const KinematicChain& robot = nominal().robot;
  const JointVector away = robot.home() + JointVector::Constant(robot.size(), 0.05);
  const JointVector no_load = JointVector::Zero(robot.size());
  const JointMatrix travel = nominal().coupling.motorTravel(robot);
  const StepContext context{1.0, 0.01, robot.home(), no_load, &travel};
  for (const std::string& name : effectNames()) {
    const std::unique_ptr<Effect> effect = makeEffect(name, robot);
    for (int i = 0; i < static_cast<int>(effect->parameters().size()); ++i)
      effect->setValue(i, 0.3 * effect->parameters()[static_cast<std::size_t>(i)].upper);
    JointVector one = away, other = away, near = away, far = robot.home();
    effect->apply(context, near, one);
    effect->apply(context, far, other);
    EXPECT_EQ(effect->remembers(), one != other) << name;
  }
}

TEST(Dependence, SaysOnWhat) {
  const Recording recording =
      makeRecording(simulateSession(with("mocap_scale", 0, 0.02), 40, 5), nominal().robot, {});
  const ResidualLayout layout = residualLayout(recording);
  SimulatedSamples simulated;
  const Eigen::VectorXd residual = residuals(recording, layout, nominal(), &simulated);
  const DependenceResult result =
      residualDependence(recording, layout, residual, simulated.joints, simulated, 5, 1);
  ASSERT_FALSE(result.groups.empty());
  EXPECT_EQ(result.groups.front().on, "position");
  EXPECT_GT(result.groups.front().lower, 0.02);
  const Dependence& time = result.groups.back();
  EXPECT_EQ(time.on, "time");
  EXPECT_LT(time.share, 0.5 * result.groups.front().share);
}

class JointSession : public testing::TestWithParam<const char*> {};

TEST_P(JointSession, NamesTheHiddenEffect) {
  plant::JointSessionOptions options;
  options.seed = 12;
  const plant::HiddenEffect hidden = plant::drawJointsHidden(options, GetParam(), 12, 10.0, 20.0);
  const plant::PlantSession session = plant::recordJointsHidden(options, {hidden});
  std::vector<bool> prismatic(6, false);
  prismatic[2] = true;
  const Verdict verdict = diagnose(session.dataset, nominal(), prismatic, {});
  EXPECT_FALSE(verdict.has_kinematics);
  EXPECT_TRUE(judge(verdict, session.truth.front()).named)
      << plant::describe(session.truth.front()) << "\n"
      << diagnosisText(verdict);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, JointSession,
                         testing::Values("command_delay", "joint_offset", "joint_coupling",
                                         "backlash"),
                         effectName);

TEST(Hypotheses, JointDataHaveNoGeometry) {
  plant::JointSessionOptions options;
  options.trajectories = 12;
  const Recording recording = makeJointRecording(plant::recordJointsClean(options).dataset,
                                                 std::vector<bool>(6, false), {});
  const std::vector<Hypothesis> hypotheses = allHypotheses(recording, nominal());
  ASSERT_GT(hypotheses.size(), 50u);
  for (const Hypothesis& hypothesis : hypotheses) {
    EXPECT_NE(hypothesis.effect, "base_registration");
    EXPECT_NE(hypothesis.effect, "link_geometry");
    EXPECT_NE(hypothesis.effect, "mocap_scale");
    EXPECT_NE(hypothesis.effect, "cable_stretch");
  }
}

TEST(Selection, RefusesFewerMotionsThanFolds) {
  DiagnosisOptions options;
  options.selection.folds = 20;
  options.least_motions = 1;
  EXPECT_THROW(diagnose(recorded(nominal()), nominal(), {}, options), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
