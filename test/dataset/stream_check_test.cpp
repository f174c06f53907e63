// SPDX-License-Identifier: BSD-3-Clause
// Each thing that can be wrong with a stream is put into a sound session and has to be named; sound
// sessions, simulated and measured ones, have no findings.
#include "raven_correction/dataset/stream_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/dataset/topic_check.h"
#include "raven_correction/error.h"
#include "raven_correction/simulation/session.h"
#include "simulation/simulations.h"
#include "support/random_poses.h"
#include "support/test_data.h"

namespace raven_correction {
namespace {

using Severity = StreamFinding::Severity;

constexpr double kDelay = 0.15, kStart = 1000.0,
                 kNotKnown = std::numeric_limits<double>::quiet_NaN();
const Pose kError{{0.015, -0.01, 0.012}, expRotation({0.1, 0.2, -0.1})};

Pose along(double t, double phase = 0.0) {
  return {{0.04 * std::sin(1.3 * t + phase), -0.06 + 0.03 * std::sin(1.9 * t + 2.0 * phase),
           -0.14 + 0.02 * std::cos(0.7 * t)},
          expRotation({0.3 * std::sin(t), 1.0 + 0.4 * std::sin(0.8 * t), 0.2 * std::cos(t)})};
}

/// Four motions of five seconds: commands at 50 Hz, observations at 120 Hz, encoders at 100 Hz.
Dataset soundSession() {
  Dataset dataset;
  dataset.frame = "0_link";
  std::mt19937_64 random(1);
  for (int k = 0; k < 4; ++k) {
    Trajectory trajectory;
    trajectory.id = "t" + std::to_string(k);
    const double start = kStart + 8.0 * k;
    const auto sample = [&](PoseStream& stream, double rate, auto&& pose) {
      for (int i = 0; i < static_cast<int>(5.0 * rate); ++i)
        stream.push_back({start + i / rate, pose(start + i / rate)});
    };
    sample(trajectory.commands, 50.0, [](double t) { return along(t); });
    sample(trajectory.observations, 120.0, [&](double t) {
      Pose seen = kError * along(t - kDelay);
      seen.p += randomVector(random, 1e-4);
      return seen;
    });
    sample(trajectory.encoders, 100.0, [](double t) { return along(t - kDelay); });
    dataset.trajectories.push_back(trajectory);
  }
  return dataset;
}

std::vector<StreamFinding> check(const Dataset& dataset) {
  return checkDataset(dataset, StreamCheckOptions());
}

std::string textOf(const std::vector<StreamFinding>& findings) {
  std::string text;
  for (const StreamFinding& finding : findings) text += toText(finding) + "\n";
  return text;
}

/// Exactly one finding, and this one.
void expectOnly(const std::vector<StreamFinding>& findings, Severity severity,
                const std::string& stream, const std::string& what, const std::string& remedy) {
  ASSERT_EQ(findings.size(), 1u) << textOf(findings);
  EXPECT_EQ(findings[0].severity, severity) << textOf(findings);
  EXPECT_EQ(findings[0].stream, stream);
  EXPECT_EQ(findings[0].what, what);
  EXPECT_NE(findings[0].remedy.find(remedy), std::string::npos) << textOf(findings);
}

TEST(StreamCheck, ASoundSessionHasNoFindings) {
  EXPECT_TRUE(check(soundSession()).empty()) << textOf(check(soundSession()));
}

TEST(StreamCheck, SimulatedSessionsHaveNoFindings) {
  for (const char* const name : {"nominal", "demo", "raven2_left_case2014", "raven2_right"}) {
    const Dataset dataset = simulateSession(shippedSimulation(name), 6, 3);
    EXPECT_TRUE(check(dataset).empty()) << name << ":\n" << textOf(check(dataset));
  }
}

TEST(StreamCheck, TheMeasuredSessionHasNoFindings) {
  const std::string path = testData("case2014_left/dataset.yaml");
  RAVEN_SKIP_WITHOUT_DATA(path, "case2014_left");
  const auto findings = check(readDatasetDirectory(path.substr(0, path.rfind('/'))));
  EXPECT_TRUE(findings.empty()) << textOf(findings);
}

TEST(StreamCheck, MillimetresAreCaughtInEveryStream) {
  const auto scaled = [](PoseStream Trajectory::*stream) {
    Dataset dataset = soundSession();
    for (Trajectory& trajectory : dataset.trajectories)
      for (StampedPose& sample : trajectory.*stream) sample.pose.p *= 1e3;
    return dataset;
  };
  expectOnly(check(scaled(&Trajectory::commands)), Severity::kError, "commands", "units",
             "millimetres");
  expectOnly(check(scaled(&Trajectory::observations)), Severity::kError, "observations", "units",
             "millimetres");
  expectOnly(check(scaled(&Trajectory::encoders)), Severity::kError, "encoders", "units",
             "millimetres");
  // Near the origin of their frame only the size of the motion tells.
  Dataset near = soundSession();
  for (Trajectory& trajectory : near.trajectories)
    for (StampedPose& sample : trajectory.observations)
      sample.pose.p = 0.02e3 * (sample.pose.p - Eigen::Vector3d(0.0, -0.06, -0.14));
  for (Trajectory& trajectory : near.trajectories)
    for (StampedPose& sample : trajectory.commands) sample.pose.p *= 0.05;
  expectOnly(check(near), Severity::kError, "observations", "units", "millimetres");
}

/// What a reader that has w last makes of a tracker that has it first.
Dataset writtenWithWFirst(Dataset dataset, const Eigen::Vector3d& registration) {
  const Pose X_base_mocap{{0.1, 1.7, -0.7}, expRotation(registration)};
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.observations) {
      Pose in_mocap = X_base_mocap.inverse() * sample.pose;
      const Eigen::Quaterniond q = in_mocap.q;
      in_mocap.q.coeffs() = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
      sample.pose = X_base_mocap * in_mocap;
    }
  return dataset;
}

TEST(StreamCheck, QuaternionsWithWFirstAreNamedWhateverTheRegistration) {
  for (const Eigen::Vector3d& registration :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, 0.4),
        Eigen::Vector3d(-0.273, -0.050, 1.586)})
    expectOnly(check(writtenWithWFirst(soundSession(), registration)), Severity::kWarning,
               "observations", "orientation", "w first");
}

TEST(StreamCheck, MarkersMayBeTurnedAgainstTheTool) {
  Dataset dataset = soundSession();
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.observations)
      sample.pose.q = sample.pose.q * expRotation({1.2, -0.9, 0.8});
  EXPECT_EQ(textOf(check(dataset)), "");
}

TEST(StreamCheck, MicrometresAreNamed) {
  Dataset dataset = soundSession();
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.encoders) sample.pose.p *= 1e6;
  expectOnly(check(dataset), Severity::kError, "encoders", "units", "micrometres");
}

TEST(StreamCheck, AStreamThatIsNotThereIsMissing) {
  Dataset dataset = soundSession();
  for (Trajectory& trajectory : dataset.trajectories) trajectory.observations.clear();
  expectOnly(check(dataset), Severity::kError, "observations", "missing", "clocks");
  for (Trajectory& trajectory : dataset.trajectories) trajectory.encoders.clear();
  expectOnly(check(dataset), Severity::kError, "observations", "missing", "clocks");
}

TEST(StreamCheck, MarkersOfAnotherToolDoNotFollow) {
  Dataset dataset = soundSession();
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.observations)
      sample.pose = along(1.7 * sample.stamp, 1.0);
  expectOnly(check(dataset), Severity::kError, "observations", "motion", "same arm and tool");
}

TEST(StreamCheck, ARegistrationFarOffIsNamed) {
  Dataset dataset = soundSession();
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.observations) sample.pose.p.x() += 0.3;
  expectOnly(check(dataset), Severity::kError, "observations", "distance", "registration");
}

TEST(StreamCheck, ObservationsBeforeTheirCommandsAreOfAnotherClock) {
  Dataset dataset = soundSession();
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.observations) sample.stamp -= kDelay + 0.1;
  expectOnly(check(dataset), Severity::kError, "observations", "clock", "chrony");
}

TEST(StreamCheck, AClockThatIsFarOffIsAWarningOrAMotionThatDoesNotFollow) {
  Dataset dataset = soundSession();
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.observations) sample.stamp += 2.0;
  const auto findings = check(dataset);
  ASSERT_EQ(findings.size(), 1u) << textOf(findings);
  EXPECT_NE(toText(findings[0]).find("clocks"), std::string::npos) << textOf(findings);
}

TEST(StreamCheck, SlowStutteringAndFrozenStreamsAreWarnings) {
  Dataset slow = soundSession();
  for (Trajectory& trajectory : slow.trajectories) {
    PoseStream thinned;
    for (std::size_t i = 0; i < trajectory.encoders.size(); i += 30)
      thinned.push_back(trajectory.encoders[i]);
    trajectory.encoders = thinned;
  }
  expectOnly(check(slow), Severity::kWarning, "encoders", "rate", "faster");

  Dataset stutters = soundSession();
  for (Trajectory& trajectory : stutters.trajectories) {
    PoseStream thinned;  // every second of three thirds of a second is missing
    for (const StampedPose& sample : trajectory.observations)
      if (std::fmod(sample.stamp - kStart, 0.4) > 0.2) thinned.push_back(sample);
    trajectory.observations = thinned;
  }
  expectOnly(check(stutters), Severity::kWarning, "observations", "gaps", "markers");

  Dataset frozen = soundSession();
  for (Trajectory& trajectory : frozen.trajectories)
    for (std::size_t i = 0; i < trajectory.observations.size(); ++i)
      trajectory.observations[i].pose = trajectory.observations[i / 3 * 3].pose;
  expectOnly(check(frozen), Severity::kWarning, "observations", "repeated", "markers");
}

// --- live ----------------------------------------------------------------------------------------

struct Live {
  StreamCheckOptions options() const {
    StreamCheckOptions options;
    options.base_frame = "0_link";
    options.window = 500;
    return options;
  }
  StreamCheck check{options()};
  double age = 0.01;
  int sent = 0;

  /// Twelve seconds of a sound session, changed by `change`.
  template <typename Change>
  std::vector<StreamFinding> run(Change change) {
    const Pose in_base;
    for (int i = 0; i < 600; ++i) {
      struct Message {
        double stamp, arrival;
        std::string frame;
        Pose pose;
      };
      const double t = kStart + 0.02 * sent++;
      Message command{t, t + age, "0_link", along(t)};
      Message seen{t, t + age, "mocap", kError * along(t - kDelay)};
      change(i, command, seen);
      check.addPose(StreamRole::kCommands, command.stamp, command.arrival, command.frame,
                    command.pose, &in_base);
      check.addPose(StreamRole::kObservations, seen.stamp, seen.arrival, seen.frame, seen.pose,
                    &in_base);
    }
    return check.allFindings();
  }
};

TEST(StreamCheckLive, ASoundStreamHasNoFindings) {
  Live live;
  const auto findings = live.run([](int, auto&, auto&) {});
  EXPECT_TRUE(findings.empty()) << textOf(findings);
}

TEST(StreamCheckLive, FramesAreHeldAgainstWhatIsExpected) {
  expectOnly(Live().run([](int, auto& command, auto&) { command.frame = "1_link"; }),
             Severity::kError, "commands", "frame", "base_frame");
  expectOnly(Live().run([](int i, auto& command, auto&) {
    if (i % 7 == 0) command.frame = "tool";
  }),
             Severity::kError, "commands", "frame", "base_frame");
  expectOnly(Live().run([](int, auto& command, auto&) { command.frame = "/0_link"; }).empty()
                 ? Live().run([](int, auto&, auto& seen) { seen.frame = ""; })
                 : std::vector<StreamFinding>(),
             Severity::kError, "observations", "frame", "mocap_frame");
  expectOnly(Live().run([](int i, auto&, auto& seen) {
    if (i % 2 == 0) seen.frame = "body_2";
  }),
             Severity::kError, "observations", "frame", "one tracked body");
}

TEST(StreamCheckLive, StampsThatGoBackOrAreZeroAreErrors) {
  const auto back = Live().run([](int i, auto& command, auto&) {
    if (i == 300) command.stamp -= 1.0;
  });
  expectOnly(back, Severity::kError, "commands", "order", "two nodes");
  EXPECT_NE(back[0].measured.find("0.980"), std::string::npos) << back[0].measured;
  expectOnly(Live().run([](int, auto&, auto& seen) { seen.stamp = 0.0; }), Severity::kError,
             "observations", "stamps", "receipt");
}

TEST(StreamCheckLive, ClocksOfOtherHostsAreNamed) {
  expectOnly(Live().run([](int, auto& command, auto&) { command.arrival -= 0.2; }),
             Severity::kWarning, "commands", "clock", "chrony");
  expectOnly(Live().run([](int, auto& command, auto&) { command.arrival -= 20.0; }),
             Severity::kError, "commands", "clock", "chrony");
  expectOnly(Live().run([](int, auto& command, auto&) { command.arrival += 1.0; }),
             Severity::kWarning, "commands", "clock", "chrony");
  expectOnly(
      Live().run([](int i, auto& command, auto&) { command.arrival += i % 10 == 0 ? 0.8 : 0.0; }),
      Severity::kWarning, "commands", "clock", "bursts");
  // An offset of 50 ms of the camera host shows as delay, and is none of the worst.
  EXPECT_TRUE(Live().run([](int, auto&, auto& seen) { seen.stamp -= 0.05; }).empty());
}

TEST(StreamCheckLive, PosesThatAreNoneAreCounted) {
  expectOnly(Live().run([](int i, auto& command, auto&) {
    if (i % 8 == 0) command.pose.p.x() = std::nan("");
  }),
             Severity::kWarning, "commands", "values", "source");
  expectOnly(Live().run([](int i, auto&, auto& seen) {
    if (i % 3 != 0) seen.pose.q.coeffs().setZero();
  }),
             Severity::kError, "observations", "values", "source");
}

TEST(StreamCheckLive, WhatIsOutOfTheWindowCountsNoMore) {
  Live live;
  live.run([](int i, auto& command, auto& seen) {
    command.pose.p *= 1e3;
    if (i == 300) command.stamp -= 1.0;
    if (i % 2 == 0) seen.frame = "body_2";
    if (i % 3 == 0) seen.pose.p.x() = std::nan("");
    if (i % 3 == 1) seen.stamp = 0.0;
  });
  EXPECT_TRUE(anyError(live.check.findings()));
  const auto findings = live.run([](int, auto&, auto&) {});  // longer than the window
  EXPECT_TRUE(findings.empty()) << textOf(findings);
}

TEST(StreamCheckLive, WhatGoesWrongAfterALongTimeIsNamedAtOnce) {
  Live live;
  for (int i = 0; i < 30; ++i) live.run([](int, auto&, auto&) {});
  expectOnly(live.run([](int, auto&, auto& seen) { seen.pose.p.x() = std::nan(""); }),
             Severity::kError, "observations", "values", "source");
}

TEST(StreamCheckLive, JointsInDegreesAreCaughtWithoutARobot) {
  StreamCheck check{StreamCheckOptions()};
  for (int i = 0; i < 50; ++i)
    check.addJoints(kStart + 0.01 * i, kNotKnown, {"shoulder", "elbow"},
                    Eigen::Vector2d(30.0, 90.0));
  expectOnly(check.findings(), Severity::kError, "joints", "units", "degrees");
}

// --- refusals and topics -------------------------------------------------------------------------

TEST(StreamFindings, ErrorsAreRefusedWithAllFindingsAndTheException) {
  const StreamFinding warning{Severity::kWarning, "a", "rate", "1 Hz", "at least 5 Hz", "faster"};
  const StreamFinding error{Severity::kError, "b", "units", "153 m", "at most 2 m", "metres"};
  EXPECT_NO_THROW(refuseErrors("s.bag", {warning}, "--force"));
  try {
    refuseErrors("s.bag", {warning, error}, "--force");
    FAIL() << "not refused";
  } catch (const InvalidInput& refused) {
    const std::string text = refused.what();
    EXPECT_EQ(text.find("s.bag: "), 0u) << text;
    EXPECT_NE(text.find("warning: a: rate: 1 Hz (at least 5 Hz); faster"), std::string::npos);
    EXPECT_NE(text.find("error: b: units: 153 m (at most 2 m); metres"), std::string::npos);
    EXPECT_NE(text.find("--force"), std::string::npos);
  }
}

TEST(CheckTopics, NamesWhatIsThereInstead) {
  const std::string pose = "geometry_msgs/PoseStamped";
  const std::vector<TopicType> published{{"/raven/left/servo_cp", "geometry_msgs/TransformStamped"},
                                         {"/phasespace_gripper_pose_L", pose},
                                         {"/raven/right/mocap/measured_cp", pose},
                                         {"/rosout", "rosgraph_msgs/Log"}};
  const auto findings = checkTopics(
      {{"/raven/left/servo_cp", pose}, {"/raven/left/mocap/measured_cp", pose}}, published);
  ASSERT_EQ(findings.size(), 2u) << textOf(findings);
  EXPECT_EQ(findings[0].what, "type");
  EXPECT_EQ(findings[0].severity, Severity::kError);
  EXPECT_NE(findings[0].measured.find("TransformStamped"), std::string::npos);
  EXPECT_EQ(findings[1].what, "missing");
  const std::string& remedy = findings[1].remedy;
  const std::size_t similar = remedy.find("/raven/right/mocap/measured_cp");
  const std::size_t same_type = remedy.find("/phasespace_gripper_pose_L");
  ASSERT_NE(similar, std::string::npos) << remedy;
  ASSERT_NE(same_type, std::string::npos) << remedy;
  EXPECT_LT(similar, same_type) << "the most similar one comes first: " << remedy;
  EXPECT_EQ(remedy.find("rosout"), std::string::npos) << remedy;
  EXPECT_TRUE(checkTopics({{"/phasespace_gripper_pose_L", ""}}, published).empty());
}

}  // namespace
}  // namespace raven_correction
