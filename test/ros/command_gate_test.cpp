// SPDX-License-Identifier: BSD-3-Clause
// Which commands a controller takes: one test per rule, each with its border.
#include "raven_correction/ros/command_gate.h"

#include <gtest/gtest.h>

#include <limits>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kNow = 1000.0;
const Eigen::Vector3d kMeasured(0.0, -0.05, -0.15);

ArrivedCommand commandAt(double stamp, const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  ArrivedCommand command;
  command.pose.stamp = stamp;
  command.pose.pose.p = kMeasured + offset;
  command.frame = "0_link";
  command.publisher = "/corrector";
  return command;
}

CommandGateConfig openGate() {
  CommandGateConfig config;
  config.discard_first = false;
  return config;
}

CommandVerdict judge(CommandGate& gate, ArrivedCommand command) {
  return gate.judge(kNow, kMeasured, command);
}

TEST(CommandGate, OnlyTheFirstCommandOfAllIsDiscarded) {
  CommandGate gate{CommandGateConfig()};
  EXPECT_EQ(judge(gate, commandAt(kNow)), CommandVerdict::kFirstDiscarded);
  EXPECT_EQ(judge(gate, commandAt(kNow)), CommandVerdict::kTaken);
  gate.reset();
  EXPECT_EQ(judge(gate, commandAt(kNow)), CommandVerdict::kFirstDiscarded);
}

TEST(CommandGate, TakesItsFrameOnly) {
  CommandGate gate(openGate());
  for (const char* frame : {"", "mocap", "0_link_r", "//0_link"}) {
    ArrivedCommand command = commandAt(kNow);
    command.frame = frame;
    EXPECT_EQ(judge(gate, command), CommandVerdict::kWrongFrame) << '"' << frame << '"';
  }
  ArrivedCommand command = commandAt(kNow);
  command.frame = "/0_link";  // as the Berkeley software writes it
  EXPECT_EQ(judge(gate, command), CommandVerdict::kTaken);
}

TEST(CommandGate, DropsTheReplayOfALatchedPublisher) {
  CommandGate gate(openGate());
  ArrivedCommand command = commandAt(kNow);
  command.replay = true;
  EXPECT_EQ(judge(gate, command), CommandVerdict::kLatched);
  command.replay = false;
  EXPECT_EQ(judge(gate, command), CommandVerdict::kTaken);
}

TEST(CommandGate, DropsWhatIsNotAPose) {
  CommandGate gate(openGate());
  ArrivedCommand command = commandAt(kNow);
  command.pose.pose.p.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(judge(gate, command), CommandVerdict::kNotFinite);
  command = commandAt(kNow);
  command.pose.pose.q.coeffs() *= 1.1;
  EXPECT_EQ(judge(gate, command), CommandVerdict::kNotUnit);
}

TEST(CommandGate, ClipsAndDropsLongStepsFromTheMeasuredPosition) {
  CommandGateConfig config = openGate();
  config.max_step = 0.015;
  config.reject_step = 0.075;
  CommandGate gate(config);
  const Eigen::Vector3d direction = Eigen::Vector3d(1.0, 2.0, -2.0) / 3.0;

  ArrivedCommand near = commandAt(kNow, 0.0149 * direction);
  const Eigen::Vector3d asked = near.pose.pose.p;
  EXPECT_EQ(gate.judge(kNow, kMeasured, near), CommandVerdict::kTaken);
  EXPECT_EQ(near.pose.pose.p, asked);

  ArrivedCommand far = commandAt(kNow, 0.0749 * direction);
  EXPECT_EQ(gate.judge(kNow, kMeasured, far), CommandVerdict::kClipped);
  EXPECT_LT((far.pose.pose.p - kMeasured - 0.015 * direction).norm(), 1e-12);

  EXPECT_EQ(judge(gate, commandAt(kNow, 0.0751 * direction)), CommandVerdict::kTooFar);

  CommandGate berkeley(openGate());  // has no such limits
  EXPECT_EQ(judge(berkeley, commandAt(kNow, 0.5 * direction)), CommandVerdict::kTaken);
}

TEST(CommandGate, BelievesAStampNearNowAndNoOther) {
  CommandGateConfig config = openGate();
  config.stamp_tolerance = 0.25;
  const struct {
    double stamp;
    double acts;
  } cases[] = {{kNow - 0.2, kNow - 0.2},
               {kNow + 0.2, kNow + 0.2},
               {kNow - 0.3, kNow},
               {kNow + 0.3, kNow},
               {0.0, kNow},
               {1e9, kNow}};
  for (const auto& test : cases) {
    CommandGate gate(config);
    ArrivedCommand command = commandAt(test.stamp);
    ASSERT_EQ(gate.judge(kNow, kMeasured, command), CommandVerdict::kTaken);
    EXPECT_EQ(command.pose.stamp, test.acts) << test.stamp;
  }
}

TEST(CommandGate, ActingStampsNeverRunBackwardsUnlessTheClockDoes) {
  CommandGate gate(openGate());
  ArrivedCommand command = commandAt(kNow + 0.2);
  gate.judge(kNow, kMeasured, command);
  command = commandAt(kNow);
  gate.judge(kNow, kMeasured, command);
  EXPECT_EQ(command.pose.stamp, kNow + 0.2);
  command = commandAt(kNow - 500.0);  // a bag that starts again
  gate.judge(kNow - 500.0, kMeasured, command);
  EXPECT_EQ(command.pose.stamp, kNow - 500.0);
}

TEST(CommandGate, CountsWhatItIsTold) {
  CommandGate gate(openGate());
  gate.count(CommandVerdict::kTaken);
  gate.count(CommandVerdict::kTaken);
  gate.count(CommandVerdict::kNoIk);
  EXPECT_EQ(gate.counted(CommandVerdict::kTaken), 2u);
  EXPECT_EQ(gate.counted(CommandVerdict::kNoIk), 1u);
  EXPECT_EQ(gate.counted(CommandVerdict::kTooFar), 0u);
}

TEST(CommandGate, RefusesABadConfiguration) {
  CommandGateConfig config;
  config.base_frame = "/";
  EXPECT_THROW(CommandGate{config}, InvalidInput);
  config = CommandGateConfig();
  config.max_step = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(CommandGate{config}, InvalidInput);
}

}  // namespace
}  // namespace raven_correction
