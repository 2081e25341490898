// SPDX-License-Identifier: MIT
/// When a run is done (formulation 9).
#include "fabseq/optimize/convergence.h"

#include <gtest/gtest.h>

#include <string>

namespace fabseq {
namespace {

OptimizerSettings settings(double change, double objective, int window) {
  OptimizerSettings result;
  result.change_tolerance = change;
  result.objective_tolerance = objective;
  result.window = window;
  return result;
}

TEST(Convergence, NeverWithoutTolerances) {
  Convergence convergence(settings(0.0, 0.0, 2), 100.0);
  for (int i = 0; i < 10; ++i) convergence.add(5.0, 0.0, 1.0);
  EXPECT_EQ(convergence.reason(true), "");
}

TEST(Convergence, EveryChangeOfTheWindowMustBeSmall) {
  Convergence convergence(settings(0.1, 0.0, 3), 100.0);
  for (const double change : {0.01, 0.01, 0.2, 0.01, 0.01}) {
    convergence.add(5.0, change, 0.0);
    EXPECT_EQ(convergence.reason(true), "") << change;
  }
  convergence.add(5.0, 0.01, 50.0);  // whatever the objective
  EXPECT_EQ(convergence.reason(false),
            "no variable moved by change_tolerance 0.1 of its range in the last 3 iterations at the last "
            "sharpness");
}

TEST(Convergence, TheObjectiveMustStayWithinTheTolerance) {
  Convergence convergence(settings(0.0, 0.01, 3), 200.0);  // 2 of the merit
  for (const double merit : {10.0, 7.0, 8.0}) convergence.add(5.0, 0.05, merit);
  EXPECT_EQ(convergence.reason(true), "");
  convergence.add(5.0, 0.05, 8.9);
  EXPECT_EQ(convergence.reason(true),
            "the objective varied by less than objective_tolerance 0.01 in the last 3 iterations at the last "
            "sharpness");
  EXPECT_EQ(convergence.reason(false), "");  // not yet feasible: there is still something to do
  convergence.add(5.0, 0.05, 11.0);
  EXPECT_EQ(convergence.reason(true), "");
}

TEST(Convergence, AnotherSharpnessStartsOver) {
  Convergence convergence(settings(0.1, 0.0, 2), 100.0);
  convergence.add(5.0, 0.01, 0.0);
  convergence.add(8.0, 0.01, 0.0);
  EXPECT_EQ(convergence.reason(true), "");
  convergence.add(8.0, 0.01, 0.0);
  EXPECT_NE(convergence.reason(true), "");
}

TEST(Convergence, GoesOnFromASavedState) {
  Convergence expected(settings(0.1, 0.0, 4), 100.0), restored(settings(0.1, 0.0, 4), 100.0);
  for (int i = 0; i < 3; ++i) expected.add(8.0, 0.01, 0.0);
  CheckpointState state;
  expected.save(state);
  restored.restore(state);
  EXPECT_EQ(restored.reason(true), "");
  restored.add(8.0, 0.01, 0.0);
  EXPECT_NE(restored.reason(true), "");
}

TEST(Convergence, AShorterWindowAfterARestartKeepsTheLatest) {
  Convergence before(settings(0.1, 0.0, 4), 100.0), after(settings(0.1, 0.0, 2), 100.0);
  for (const double change : {0.3, 0.3, 0.01, 0.01}) before.add(8.0, change, 0.0);
  EXPECT_EQ(before.reason(true), "");
  CheckpointState state;
  before.save(state);
  after.restore(state);
  EXPECT_NE(after.reason(true), "");
}

}  // namespace
}  // namespace fabseq
