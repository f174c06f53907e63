// SPDX-License-Identifier: BSD-3-Clause
// Blocks of time against the motion that they were cut from: nothing is lost, and the arm does in
// them what it does in the whole.
#include "raven_correction/diagnosis/blocks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/joint_session.h"
#include "raven_correction/diagnosis/effect_fit.h"
#include "raven_correction/diagnosis/noise_floor.h"

namespace raven_correction {
namespace {

constexpr int kMotions = 2, kLeast = 10;

Recording recorded() {
  plant::JointSessionOptions options;
  options.trajectories = kMotions;
  return makeJointRecording(plant::recordJointsClean(options).dataset,
                            {false, false, true, false, false, false}, {});
}

/// A command when something changes, 0.7 s apart, and none at all for more than a block's time.
Recording commandedOnChange() {
  Recording recording = recorded();
  for (Recording::Motion& motion : recording.motions) {
    std::vector<Recording::Setpoint> kept;
    const double start = motion.setpoints.front().stamp;
    const double length = motion.setpoints.back().stamp - start;
    for (const Recording::Setpoint& setpoint : motion.setpoints) {
      const double share = (setpoint.stamp - start) / length;
      if ((share > 0.35 && share < 0.65) ||
          (!kept.empty() && setpoint.stamp < kept.back().stamp + 0.7))
        continue;
      kept.push_back(setpoint);
    }
    motion.setpoints = kept;
  }
  return recording;
}

/// Cameras that saw nothing for more than a block's time, in the middle and at the end.
Recording partlySeen() {
  Recording recording = recorded();
  for (Recording::Motion& motion : recording.motions) {
    const double start = motion.setpoints.front().stamp;
    const double length = motion.setpoints.back().stamp - start;
    std::vector<Recording::Observation> kept;
    for (const Recording::Observation& observation : motion.observations) {
      const double share = (observation.stamp - start) / length;
      if (share < 0.15 || (share > 0.5 && share < 0.75)) kept.push_back(observation);
    }
    motion.observations = kept;
  }
  return recording;
}

struct Case {
  const char* name;
  Recording (*make)();
  std::size_t blocks;
};

class Blocks : public testing::TestWithParam<Case> {};

TEST_P(Blocks, LoseNothing) {
  const Recording whole = GetParam().make();
  ASSERT_EQ(whole.motions.size(), static_cast<std::size_t>(kMotions));
  Recording cut = whole;
  cutIntoBlocks(kLeast, cut);
  EXPECT_EQ(cut.motions.size(), GetParam().blocks);
  const auto counts = [](const Recording& recording) {
    std::vector<std::size_t> sums(3, 0);
    for (const Recording::Motion& motion : recording.motions) {
      sums[0] += motion.setpoints.size() - motion.carried;
      sums[1] += motion.observations.size();
      sums[2] += motion.frames.size();
    }
    return sums;
  };
  EXPECT_EQ(counts(cut), counts(whole));
  for (const Recording::Motion& block : cut.motions) {
    EXPECT_FALSE(block.setpoints.empty());
    EXPECT_FALSE(block.observations.empty());
    if (block.carried > 0) {
      EXPECT_LE(block.setpoints.front().stamp, block.observations.front().stamp);
    }
  }
}

TEST_P(Blocks, LeaveTheResidualsOfTheWholeMotion) {
  const Recording whole = GetParam().make();
  Recording cut = whole;
  cutIntoBlocks(kLeast, cut);
  const ResidualLayout layout = residualLayout(whole), layout_cut = residualLayout(cut);
  ASSERT_EQ(layout.size, layout_cut.size);
  SimulationConfig simulation;
  simulation.robot = whole.robot;
  Eigen::VectorXd values(5);
  values << 0.2, 0.3, 0.1, 0.03, 0.02;
  simulation = withValues(simulation,
                          {{"backlash", 0},
                           {"backlash", 3},
                           {"tracking_lag", 1},
                           {"command_delay", 0},
                           {"drive_friction", 4}},
                          values);
  for (const SetpointMode mode : {SetpointMode::kHold, SetpointMode::kLinear}) {
    simulation.setpoints = mode;
    EXPECT_EQ(residuals(cut, layout_cut, simulation), residuals(whole, layout, simulation));
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, Blocks,
                         testing::Values(Case{"as_it_is", &recorded, 10},
                                         Case{"commanded_on_change", &commandedOnChange, 10},
                                         Case{"partly_seen", &partlySeen, 6}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(BlocksOfTime, AreNotNeededWithEnoughMotions) {
  Recording recording = recorded();
  cutIntoBlocks(kMotions, recording);
  EXPECT_EQ(recording.motions.size(), static_cast<std::size_t>(kMotions));
  EXPECT_EQ(recording.motions.front().carried, 0u);
}

// Frames of a block are in its time, so the noise is that of the whole but for the runs that a cut
// went through.
TEST(BlocksOfTime, HaveTheNoiseOfTheWhole) {
  const Recording whole = recorded();
  Recording cut = whole;
  cutIntoBlocks(kLeast, cut);
  SimulationConfig simulation;
  simulation.robot = whole.robot;
  const Eigen::VectorXd floor = noiseFloor(whole, simulation), of_cut = noiseFloor(cut, simulation);
  for (Eigen::Index j = 0; j < floor.size(); ++j) EXPECT_NEAR(of_cut(j), floor(j), 0.1 * floor(j));
}

}  // namespace
}  // namespace raven_correction
