// SPDX-License-Identifier: BSD-3-Clause
// What a request for a diagnosis makes of its data set: which trajectories are used, and what the
// extended simulation says of them.
#include "raven_correction/ros/diagnosis_job.h"

#include <gtest/gtest.h>

#include "raven_correction/evaluation/validated_training.h"
#include "raven_correction/simulation/session.h"
#include "support/temporary_directory.h"

namespace raven_correction {
namespace {

TEST(DiagnosisJob, LeavesOutWhatATrainerValidatesOnAndSaysWhatItWasFittedTo) {
  const SimulationConfig nominal = loadSimulationConfig("config/simulation/nominal.yaml");
  const Dataset session = simulateSession(
      withValues(nominal, {{"joint_offset", 1}}, Eigen::VectorXd::Constant(1, 0.03)), 12, 5);
  const ValidationSplit split = splitForValidation(session);
  ASSERT_FALSE(split.held_out.trajectories.empty());
  DiagnosisJob job;
  job.options.recording.max_samples = 300;
  job.options.selection.max_causes = 1;
  job.options.selection.finalists = 2;
  job.options.least_motions = 5;
  const Verdict all = runDiagnosis(session, nominal, job, {});
  EXPECT_EQ(all.motions, 12);
  EXPECT_EQ(overlapOf(all.simulation, split.held_out).seen, split.held_out.trajectories.size());

  job.leave_out_validation = true;
  const Verdict fair = runDiagnosis(session, nominal, job, {});
  EXPECT_EQ(fair.motions, static_cast<int>(split.training.trajectories.size()));
  const TemporaryDirectory directory;
  const std::string file = directory.path() + "/extended.yaml";
  saveSimulationConfig(fair.simulation, file);
  const SimulationConfig read = loadSimulationConfig(file);
  EXPECT_EQ(read.fitted_to, fair.simulation.fitted_to);
  EXPECT_TRUE(overlapOf(read, split.held_out).independent());
  EXPECT_EQ(overlapOf(read, split.training).seen, split.training.trajectories.size());
  EXPECT_FALSE(
      overlapOf(withValues(nominal, {{"joint_offset", 1}}, Eigen::VectorXd::Constant(1, 0.03)),
                split.held_out)
          .known);
  EXPECT_TRUE(overlapOf(nominal, split.held_out).independent()) << "there is nothing to fit in it";
}

}  // namespace
}  // namespace raven_correction
