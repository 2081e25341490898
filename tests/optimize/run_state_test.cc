// SPDX-License-Identifier: MIT
/// How closely the solves of an iteration go where the tolerance follows the design
/// (docs/developer/optimizer.md 9.4).
#include "fabseq/optimize/run_state.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

TEST(FollowingTolerance, GoesWithTheStepAndTheRootOfWhatIsLeft) {
  EXPECT_DOUBLE_EQ(following_tolerances(0.03, 1.0).primal.value, 9e-3);
  EXPECT_DOUBLE_EQ(following_tolerances(0.003, 1.0).primal.value, 9e-4);
  EXPECT_DOUBLE_EQ(following_tolerances(0.03, 1e-4).primal.value, 9e-5);
}

TEST(FollowingTolerance, StaysWithinItsBounds) {
  EXPECT_EQ(following_tolerances(0.5, 1.0).primal.value, 1e-2);
  EXPECT_EQ(following_tolerances(0.001, 1e-8).primal.value, 1e-6);
  EXPECT_EQ(following_tolerances(0.05, 0.0).primal.value, 1e-6);
}

TEST(FollowingTolerance, GradientsNeedNotBeCloserThanAnOptimizerReadsThem) {
  EXPECT_DOUBLE_EQ(following_tolerances(0.05, 1.0).adjoint.value, 3e-3);
  EXPECT_DOUBLE_EQ(following_tolerances(0.001, 1e-6).adjoint.value, 3e-3);
}

TEST(FollowingTolerance, ValuesThatCompareIteratesNeedAFractionOfAPercent) {
  EXPECT_DOUBLE_EQ(following_tolerances(0.05, 1.0).judged.value, 1e-3);
  EXPECT_DOUBLE_EQ(following_tolerances(0.001, 1e-4).judged.value, 1e-5);
  EXPECT_EQ(following_tolerances(0.001, 0.0).judged.value, 1e-6);
}

TEST(FollowingTolerance, TheLastStepsOfSolvesAreNotMeasured) {
  const Tolerances following = following_tolerances(0.05, 1.0);
  for (const SolveTolerance& tolerance : {following.primal, following.adjoint, following.judged})
    EXPECT_EQ(tolerance.reach, 3.0);
  EXPECT_EQ(Tolerances::all({1e-6}).primal.reach, 1.0);
}

TEST(FollowingTolerance, ANumberIsTheToleranceOfEverything) {
  SolverSettings settings;
  EXPECT_EQ(settings.finest_tolerance(), 1e-6);
  settings.tolerance = 1e-4;
  EXPECT_EQ(settings.finest_tolerance(), 1e-4);
  settings.tolerance.reset();
  EXPECT_EQ(settings.finest_tolerance(), 1e-6);
}

}  // namespace
}  // namespace fabseq
