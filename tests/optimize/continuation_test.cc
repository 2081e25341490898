// SPDX-License-Identifier: MIT
/// Schedules of sharpness and move limit (formulation 3.1, 9).
#include "fabseq/optimize/continuation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

OptimizerSettings run_of(int iterations) {
  OptimizerSettings result;
  result.max_iterations = iterations;
  result.move_limit = 0.05;
  result.final_move_limit = 0.004;
  return result;
}

TEST(Continuation, AutomaticSharpnessGrowsByHalfEveryFifteenIterations) {
  // N = 24: 96, 144, 216, then 324 = 13.5 N exactly.
  const Continuation continuation({}, 4.0 * 24, 13.5 * 24, run_of(120));
  const double expected[] = {96, 144, 216, 324, 324};
  for (int step = 0; step < 5; ++step) {
    EXPECT_DOUBLE_EQ(continuation.beta(15 * step + 1), expected[step]);
    EXPECT_DOUBLE_EQ(continuation.beta(15 * step + 15), expected[step]);
  }
  EXPECT_FALSE(continuation.at_last_beta(45));
  EXPECT_TRUE(continuation.at_last_beta(46));
}

TEST(Continuation, PublishedSharpnessGrowsByTwenty) {
  ProjectionSettings published;
  published.factor = 1.0;
  published.increment = 20.0;
  const Continuation continuation(published, 10.0, 510.0, run_of(400));
  for (int iteration = 1; iteration <= 375; ++iteration)
    EXPECT_DOUBLE_EQ(continuation.beta(iteration), 10.0 + 20.0 * ((iteration - 1) / 15)) << iteration;
  EXPECT_DOUBLE_EQ(continuation.beta(376), 510.0);
  EXPECT_DOUBLE_EQ(continuation.beta(400), 510.0);
}

TEST(Continuation, SharpnessStopsAtTheMaximumEvenBetweenSteps) {
  ProjectionSettings settings;
  settings.factor = 1.0;
  settings.increment = 10.0;
  settings.interval = 30;
  const Continuation continuation(settings, 30.0, 65.0, run_of(1000));
  EXPECT_DOUBLE_EQ(continuation.beta(90), 50.0);
  EXPECT_DOUBLE_EQ(continuation.beta(91), 60.0);
  EXPECT_DOUBLE_EQ(continuation.beta(121), 65.0);
  EXPECT_DOUBLE_EQ(continuation.beta(1000), 65.0);
}

/// A run in three pieces has the schedules of the whole.
TEST(Continuation, EarlierAndLaterIterationsAreOfTheSameSchedule) {
  const Continuation whole({}, 96.0, 324.0, run_of(120));
  OptimizerSettings piece = run_of(40);
  piece.later_iterations = 60;
  piece.earlier_iterations = 5;
  piece.coarse_iterations = 15;
  const Continuation middle({}, 96.0, 324.0, piece);
  for (int iteration = 1; iteration <= 40; ++iteration) {
    EXPECT_DOUBLE_EQ(middle.beta(iteration), whole.beta(20 + iteration));
    EXPECT_DOUBLE_EQ(middle.move_limit(iteration), whole.move_limit(20 + iteration));
  }
}

TEST(Continuation, AMaximumBelowTheStartKeepsTheStart) {
  const Continuation continuation({}, 100.0, 50.0, run_of(100));
  EXPECT_DOUBLE_EQ(continuation.beta(1), 100.0);
  EXPECT_DOUBLE_EQ(continuation.beta(100), 100.0);
  EXPECT_TRUE(continuation.at_last_beta(1));
}

/// A run too short for the maximum ends at a lower sharpness; its best design is sought there.
TEST(Continuation, ShortRunsHaveAnEarlierLastSharpness) {
  const Continuation continuation({}, 96.0, 324.0, run_of(20));
  EXPECT_FALSE(continuation.at_last_beta(15));
  EXPECT_TRUE(continuation.at_last_beta(16));
  EXPECT_FALSE(continuation.reaches_the_end());
  EXPECT_TRUE(Continuation({}, 96.0, 324.0, run_of(46)).reaches_the_end());
  ProjectionSettings constant;
  constant.factor = 1.0;
  EXPECT_TRUE(Continuation(constant, 10.0, 324.0, run_of(5)).reaches_the_end());
}

TEST(Continuation, RepairsHaveTheLastSharpnessAndMoveLimitAndAreJudged) {
  OptimizerSettings settings = run_of(20);
  settings.binary_iterations = 5;
  settings.repair_iterations = 30;
  const Continuation continuation({}, 96.0, 324.0, settings);
  for (const int iteration : {21, 35, 50}) {
    EXPECT_EQ(continuation.beta(iteration), continuation.beta(20));
    EXPECT_DOUBLE_EQ(continuation.move_limit(iteration), 0.004);
    EXPECT_TRUE(continuation.judges_binary(iteration));
  }
}

TEST(Continuation, MoveLimitIsConstantThenFallsGeometrically) {
  const Continuation continuation({}, 96.0, 324.0, run_of(100));
  for (int iteration = 1; iteration <= 40; ++iteration)
    EXPECT_DOUBLE_EQ(continuation.move_limit(iteration), 0.05);
  const double ratio = continuation.move_limit(42) / continuation.move_limit(41);
  EXPECT_LT(ratio, 1.0);
  for (int iteration = 41; iteration <= 100; ++iteration)
    EXPECT_NEAR(continuation.move_limit(iteration) / continuation.move_limit(iteration - 1), ratio, 1e-12);
  EXPECT_NEAR(continuation.move_limit(70), std::sqrt(0.05 * 0.004), 1e-12);  // half way, the geometric mean
  EXPECT_NEAR(continuation.move_limit(100), 0.004, 1e-15);
  EXPECT_NEAR(continuation.move_limit(150), 0.004, 1e-15);
}

TEST(Continuation, TheLastTenthIsNearTheEnd) {
  const Continuation continuation({}, 96.0, 324.0, run_of(100));
  EXPECT_FALSE(continuation.near_the_end(1));
  EXPECT_FALSE(continuation.near_the_end(90));
  EXPECT_TRUE(continuation.near_the_end(91));
  EXPECT_TRUE(continuation.near_the_end(150));
  OptimizerSettings coarse = run_of(50);
  coarse.later_iterations = 50;
  EXPECT_FALSE(Continuation({}, 96.0, 324.0, coarse).near_the_end(50));
}

TEST(Continuation, EqualLimitsStayConstant) {
  OptimizerSettings settings = run_of(50);
  settings.move_limit = settings.final_move_limit = 0.2;
  const Continuation continuation({}, 10.0, 20.0, settings);
  for (int iteration = 1; iteration <= 50; ++iteration)
    EXPECT_DOUBLE_EQ(continuation.move_limit(iteration), 0.2);
}

TEST(Continuation, ARunOfAnotherLengthKeepsTheMoveLimitsItWasPlannedWith) {
  const Continuation planned({}, 4.0, 13.5, run_of(100));
  Continuation longer({}, 4.0, 13.5, run_of(200));
  EXPECT_NE(longer.move_limit(70), planned.move_limit(70));
  CheckpointState state;
  planned.save(state);
  longer.restore(state);
  for (int iteration = 1; iteration <= 100; ++iteration)
    EXPECT_EQ(longer.move_limit(iteration), planned.move_limit(iteration)) << iteration;
  EXPECT_DOUBLE_EQ(longer.move_limit(150), 0.004);
  EXPECT_FALSE(longer.at_last_beta(1));
}

}  // namespace
}  // namespace fabseq
