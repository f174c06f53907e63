// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/training.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "raven_correction/error.h"
#include "support/simple_model.h"
#include "support/temporary_directory.h"

namespace raven_correction {
namespace {

/// Motions whose observations come through an inverse rigid transform, a delay and noise.
Dataset recording(int trajectories, const Pose& X_command_observed, double delay) {
  std::mt19937_64 random(1);
  Dataset dataset;
  dataset.source = "made";
  for (int k = 0; k < trajectories; ++k) {
    Trajectory trajectory;
    trajectory.id = "t" + std::to_string(k);
    const Eigen::Vector3d phase = randomVector(random, 2.0);
    const auto pose = [&](double t) {
      const Eigen::Vector3d angle = (phase.array() + 2.0 * t).matrix();
      return Pose{0.03 * angle.array().sin().matrix(),
                  expRotation(0.2 * angle.array().cos().matrix())};
    };
    for (int i = 0; i < 120; ++i)
      trajectory.commands.push_back({10.0 * k + 0.02 * i, pose(0.02 * i)});
    for (int i = 0; i < 240; ++i) {
      Pose seen = X_command_observed.inverse() * pose(0.01 * i - delay);
      seen.p += randomVector(random, 1e-4);
      trajectory.observations.push_back({10.0 * k + 0.01 * i, seen});
    }
    dataset.trajectories.push_back(trajectory);
  }
  return dataset;
}

TrainingConfig quick() {
  TrainingConfig config;
  config.process.max_hyper_points = 150;
  config.process.inducing_points = 60;
  config.process.groups = {{0, 1, 2, 3, 4, 5}};
  return config;
}

TEST(Train, FindsDelayAndRigidTransform) {
  const Pose X{{0.01, 0.02, -0.01}, expRotation({0.1, 0.2, -0.1})};
  const TrainingResult result = train(recording(8, X, 0.14), quick(), 1000.0);
  EXPECT_NEAR(result.model.delay, 0.14, 0.003);
  EXPECT_LT((result.model.rigid.p - X.p).norm(), 5e-4);
  EXPECT_LT(rotationAngle(result.model.rigid.q, X.q), 5e-3);
  EXPECT_EQ(result.fates.total(), 8u * 240u);
  EXPECT_EQ(result.fates[Fate::kKept], result.model.training_pairs);
  EXPECT_EQ(result.model.training_trajectories, 8u);
  EXPECT_EQ(result.model.id.substr(0, 16), "19700101T001640Z");
}

TEST(Train, IsDeterministic) {
  const Dataset dataset = recording(6, Pose(), 0.1);
  const Correction a = train(dataset, quick(), 1.0).model, b = train(dataset, quick(), 1.0).model;
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.process.groups[0].weights, b.process.groups[0].weights);
}

TEST(Train, SaysWhyNothingIsLeft) {
  TrainingConfig config = quick();
  config.cleaning.limits.speed = 1e-6;
  try {
    train(recording(6, Pose(), 0.1), config, 1.0);
    FAIL();
  } catch (const InvalidInput& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("made"), std::string::npos) << text;
    EXPECT_NE(text.find("speed"), std::string::npos) << text;
  }
}

TEST(TrainingConfig, ShippedFilesLoadAndMistakesAreNamed) {
  EXPECT_EQ(loadTrainingConfig("config/trainer.yaml").name, "best");
  const TrainingConfig paper = loadTrainingConfig("config/trainer_case2014.yaml");
  EXPECT_EQ(paper.motion.velocity, VelocityKind::kCentral);
  EXPECT_FALSE(paper.estimate_delay);
  EXPECT_FALSE(paper.process.ard);
  EXPECT_EQ(paper.process.kernel, KernelType::kSquaredExponential);
  const TemporaryDirectory folder;
  const std::string file = folder.path() + "/trainer.yaml";
  std::ofstream(file) << "motion:\n  velocity: fast\n  windw: 0.1\ntrust:\n  fade_start: 2\n";
  try {
    loadTrainingConfig(file);
    FAIL();
  } catch (const InvalidInput& error) {
    const std::string text = error.what();
    for (const char* const part : {"velocity", "windw", "window", "fade_start"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_THROW(loadTrainingConfig(folder.path() + "/none.yaml"), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
