// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/test_trace.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/evaluation/table_one.h"
#include "raven_correction/simulation/session.h"
#include "report/quick_training.h"

namespace raven_correction {
namespace {

const Dataset& session() {
  static const Dataset dataset =
      simulateSession(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"), 15, 3);
  return dataset;
}

TraceProblem quick() {
  TraceProblem problem;
  problem.config = quickTraining();
  problem.hold_out = {1, 5};
  return problem;
}

// All clean states, and their errors, are those that the table of all methods has for this fold.
TEST(TestTrace, AgreesWithTableOne) {
  TraceProblem problem = quick();
  problem.states = 100000;
  const TraceResult result = testTrace(session(), problem);
  TableOneProblem table;
  table.configurations = {{"quick", problem.config}};
  const TableOneResult expected = crossValidate(session(), table);
  const auto norm = [&](Method method) {
    return expected.row("quick", method, true, 1).errors.position_norm;
  };
  EXPECT_EQ(result.test_trajectories, 3u);
  EXPECT_EQ(result.states.size(), result.clean_states);
  EXPECT_EQ(result.states.size(),
            expected.row("quick", Method::kRigidGpVelocityClean, true, 1).errors.n);
  EXPECT_NEAR(result.none.position_norm, norm(Method::kNone), 1e-12);
  EXPECT_NEAR(result.rigid.position_norm, norm(Method::kRigidClean), 1e-12);
  EXPECT_NEAR(result.full.position_norm, norm(Method::kRigidGpVelocityClean), 1e-12);
}

TEST(TestTrace, HasTheFirstStatesInOrder) {
  TraceProblem problem = quick();
  const TraceResult all = testTrace(session(), problem);
  problem.states = 50;
  const TraceResult some = testTrace(session(), problem);
  ASSERT_EQ(some.states.size(), 50u);
  EXPECT_EQ(some.clean_states, all.clean_states);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(some.states[i].full.p, all.states[i].full.p);
    if (i == 0) continue;
    EXPECT_GE(some.states[i].trajectory, some.states[i - 1].trajectory);
  }
  EXPECT_EQ(some.full.n, 50u);
}

TEST(TestTrace, RefusesAnEmptyFoldAndNoStates) {
  TraceProblem problem = quick();
  problem.states = 0;
  EXPECT_THROW(testTrace(session(), problem), InvalidInput);
  problem = quick();
  problem.hold_out = {16, 17};
  EXPECT_THROW(testTrace(session(), problem), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
