// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/learnable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/fixtures.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

struct Data {
  Recording recording;
  ResidualLayout layout;
  Eigen::MatrixXd joints;
};

const Data& data() {
  static const Data all = [] {
    Data made;
    RecordingOptions options;
    options.max_samples = 900;
    made.recording = makeRecording(simulateSession(nominal(), 20, 5), nominal().robot, options);
    made.layout = residualLayout(made.recording);
    SimulatedSamples simulated;
    residuals(made.recording, made.layout, nominal(), &simulated);
    made.joints = simulated.joints;
    return made;
  }();
  return all;
}

/// Residual of noise and, in the position, of a smooth function of two joints.
Eigen::VectorXd residualOf(double structure, double noise) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0.0, noise);
  Eigen::VectorXd residual(data().layout.size);
  for (std::size_t b = 0; b < data().layout.blocks.size(); ++b) {
    const ResidualBlock& block = data().layout.blocks[b];
    const auto q = data().joints.col(static_cast<Eigen::Index>(b));
    for (int i = 0; i < 3; ++i) residual(block.offset + i) = normal(random);
    if (block.channel == 0) residual(block.offset) += structure * std::sin(4.0 * q(0) + 2.0 * q(1));
  }
  return residual;
}

double rms(const Eigen::VectorXd& residual) {
  return errorSizes(data().layout, residual).position_rms;
}

TEST(Learnable, ASmoothFunctionOfTheJointsIsLearnt) {
  const Eigen::VectorXd before = residualOf(2e-3, 1e-4);
  const Eigen::VectorXd after =
      withoutLearnable(data().recording, data().layout, before, data().joints, 5, 1);
  EXPECT_LT(rms(after), 0.75 * rms(before));  // 20 motions show a third of it
}

TEST(Learnable, NoiseIsNot) {
  const Eigen::VectorXd before = residualOf(0.0, 1e-3);
  const Eigen::VectorXd after =
      withoutLearnable(data().recording, data().layout, before, data().joints, 5, 1);
  EXPECT_GT(rms(after), 0.98 * rms(before));
  EXPECT_LT(rms(after), 1.05 * rms(before));
}

// A motion is predicted from others: what is its own cannot be learnt.
TEST(Learnable, WhatOneMotionAloneShowsIsNot) {
  Eigen::VectorXd before = residualOf(0.0, 1e-4);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0.0, 2e-3);
  std::vector<double> own;
  for (int m = 0; m < data().layout.motions; ++m) own.push_back(normal(random));
  for (const ResidualBlock& block : data().layout.blocks)
    if (block.channel == 0) before(block.offset) += own[static_cast<std::size_t>(block.motion)];
  const Eigen::VectorXd after =
      withoutLearnable(data().recording, data().layout, before, data().joints, 5, 1);
  EXPECT_GT(rms(after), 0.7 * rms(before));
}

// A correction does not know the command that comes next.
TEST(Learnable, DoesNotLookAhead) {
  Recording recording = data().recording;
  for (Recording::Motion& motion : recording.motions)
    motion.observations.resize((motion.observations.size() + 1) / 2);
  const ResidualLayout layout = residualLayout(recording);
  SimulatedSamples simulated;
  residuals(recording, layout, nominal(), &simulated);
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal(0.0, 1e-3);
  Eigen::VectorXd residual(layout.size);
  for (double& value : residual) value = normal(random);
  const auto learnt = [&] {
    return withoutLearnable(recording, layout, residual, simulated.joints, 2, 1);
  };
  const Eigen::VectorXd before = learnt();
  const auto move = [&](bool future) {
    for (Recording::Motion& motion : recording.motions)
      for (Recording::Setpoint& setpoint : motion.setpoints)
        if ((setpoint.stamp > motion.observations.back().stamp) == future)
          setpoint.joints.array() += 0.3 * normal(random) / 1e-3;
  };
  move(true);
  EXPECT_EQ(learnt(), before);
  move(false);
  EXPECT_NE(learnt(), before);
}

}  // namespace
}  // namespace raven_correction
