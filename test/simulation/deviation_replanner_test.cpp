// SPDX-License-Identifier: BSD-3-Clause
// A deviation that is measured is undone by the next commands; faults of motion capture are not.
#include "raven_correction/simulation/deviation_replanner.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

/// A tool that is off by a constant.
struct Tool {
  Eigen::Vector3d d{0.02, -0.01, 0.015}, r{0.1, -0.3, 0.2};
  Pose at(const Pose& command) const { return {command.p + d, command.q * expRotation(r)}; }
};

struct Session {
  PoseStream commands, observed;
  /// Commands and observations of half a second, from `begin` on.
  void run(const DeviationReplanner& replanner, const Pose& desired, const Tool& tool,
           double begin) {
    commands.clear();
    observed.clear();
    for (int k = 0; k <= 25; ++k) {
      const double t = begin + 0.02 * k;
      commands.push_back({t, replanner.command(desired, t)});
      observed.push_back({t, tool.at(commands.back().pose)});
    }
  }
};

TEST(DeviationReplanner, UndoesWhatWasMeasured) {
  DeviationReplanner replanner({});
  const Pose desired{{0.01, 0.02, -0.16}, expRotation({0.3, 1.0, -0.4})};
  const Tool tool;
  Session session;
  session.run(replanner, desired, tool, 0.0);
  EXPECT_EQ(session.commands.back().pose.p, desired.p);
  ASSERT_TRUE(replanner.measure(session.commands, session.observed, 0.5));
  session.run(replanner, desired, tool, 1.0);  // it is blended in until then
  EXPECT_LT((session.observed.back().pose.p - desired.p).norm(), 1e-9);
  EXPECT_LT(rotationAngle(session.observed.back().pose.q, desired.q), 1e-9);
  replanner.forget(1.5);
  EXPECT_LT((replanner.command(desired, 3.0).p - desired.p).norm(), 1e-12);
}

TEST(DeviationReplanner, GoesFromOneMeasurementToTheNextWithoutAJump) {
  DeviationReplanner replanner({});
  const Pose desired;
  const Tool tool;
  Session session;
  session.run(replanner, desired, tool, 0.0);
  ASSERT_TRUE(replanner.measure(session.commands, session.observed, 0.5));
  Eigen::Vector3d last = replanner.command(desired, 0.5).p;
  EXPECT_LT(last.norm(), 1e-12);
  for (double t = 0.5; t < 1.0; t += 0.02) {
    const Eigen::Vector3d p = replanner.command(desired, t).p;
    EXPECT_LT((p - last).norm(), tool.d.norm() * 0.02 / 0.4 + 1e-9);
    last = p;
  }
  EXPECT_NEAR((last + tool.d).norm(), 0.0, 1e-9);
}

TEST(DeviationReplanner, DoesNotBelieveASingleJump) {
  DeviationReplanner replanner({});
  const Pose desired;
  Tool tool;
  Session session;
  session.run(replanner, desired, tool, 0.0);
  ASSERT_TRUE(replanner.measure(session.commands, session.observed, 0.5));
  const Eigen::Vector3d before = replanner.translation();
  tool.r.x() += 1.2;  // two markers were taken for one another
  session.run(replanner, desired, tool, 1.0);
  EXPECT_FALSE(replanner.measure(session.commands, session.observed, 1.5));
  EXPECT_FALSE(replanner.measure(session.commands, session.observed, 2.5));
  EXPECT_EQ(replanner.translation(), before);
  EXPECT_TRUE(replanner.measure(session.commands, session.observed, 3.5)) << "they all say so";
}

// A corrected tool is where it should be: LEDs that are taken for one another must not drive it
// away.
TEST(DeviationReplanner, ExpectsNothingOfACorrectedTool) {
  const Pose desired{{0.01, 0.02, -0.16}, expRotation({0.3, 1.0, -0.4})};
  const Tool wrong;  // by 27 mm
  Tool near;
  near.d = {0.001, 0.0, -0.001};
  near.r.setZero();
  ReplanConfig config;
  config.corrected = true;
  DeviationReplanner replanner(config);
  Session session;
  session.run(replanner, desired, wrong, 0.0);
  EXPECT_FALSE(replanner.measure(session.commands, session.observed, 0.5));
  EXPECT_EQ(replanner.command(desired, 5.0).p, desired.p);
  session.run(replanner, desired, near, 1.0);
  EXPECT_TRUE(replanner.measure(session.commands, session.observed, 1.5));
  EXPECT_NEAR((replanner.translation() - near.d).norm(), 0.0, 1e-12);
  replanner.forget(2.0);  // another place
  session.run(replanner, desired, wrong, 3.0);
  EXPECT_FALSE(replanner.measure(session.commands, session.observed, 3.5));
  // Not a tool that nobody corrects: there the first measurement is what is undone.
  DeviationReplanner uncorrected({});
  session.run(uncorrected, desired, wrong, 4.0);
  EXPECT_TRUE(uncorrected.measure(session.commands, session.observed, 4.5));
}

TEST(DeviationReplanner, NeedsObservationsBetweenCommands) {
  DeviationReplanner replanner({});
  Session session;
  session.run(replanner, {}, {}, 0.0);
  PoseStream few(session.observed.begin(), session.observed.begin() + 4);
  EXPECT_FALSE(replanner.measure(session.commands, few, 0.5));
  EXPECT_FALSE(replanner.measure({}, session.observed, 0.5));
  ReplanConfig wrong;
  wrong.blend = 0.0;
  EXPECT_THROW(DeviationReplanner{wrong}, InvalidInput);
}

}  // namespace
}  // namespace raven_correction
