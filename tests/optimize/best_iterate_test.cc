// SPDX-License-Identifier: MIT
/// Which design a run keeps.
#include "fabseq/optimize/best_iterate.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

ProblemValues values(double merit, double worst_constraint) {
  ProblemValues result;
  result.merit = merit;
  result.worst_constraint = result.worst_unchecked = worst_constraint;
  return result;
}

/// Only smooth counts of what is checked exactly are violated.
ProblemValues counted(double merit, double worst_constraint) {
  ProblemValues result = values(merit, worst_constraint);
  result.worst_unchecked = -0.1;
  return result;
}

/// Offers iterates with the iteration number as design.
class BestIterateTest : public testing::Test {
 protected:
  void offer(int iteration, double beta, double merit, double worst_constraint) {
    best_.offer({iteration, beta, values(merit, worst_constraint), {}},
                {{static_cast<double>(iteration)}, {}});
  }
  void offer_judged(int iteration, const ProblemValues& smooth, const ProblemValues& binary,
                    std::optional<double> beyond_limits = std::nullopt) {
    JudgedValues judged{binary, std::nullopt};
    if (beyond_limits) judged.beyond_limits = BeyondLimits{*beyond_limits, {}, 0};
    best_.offer({iteration, 10.0, smooth, std::move(judged)}, {{static_cast<double>(iteration)}, {}});
  }
  void expect(int iteration) {
    EXPECT_EQ(best_.iteration(), iteration);
    EXPECT_EQ(best_.design().field, std::vector<double>{static_cast<double>(iteration)});
  }
  BestIterate best_{"time_points"};
};

TEST_F(BestIterateTest, BeginsWithNone) {
  EXPECT_EQ(best_.iteration(), 0);
  EXPECT_TRUE(best_.design().field.empty());
}

TEST_F(BestIterateTest, KeepsTheFirstWhateverItIs) {
  offer(1, 10.0, 1e9, 0.8);
  expect(1);
  EXPECT_FALSE(best_.feasible());
  EXPECT_EQ(best_.worst_constraint(), 0.8);
}

TEST_F(BestIterateTest, FeasibleBeatsInfeasible) {
  offer(1, 10.0, 1.0, 0.1);
  offer(2, 10.0, 50.0, -0.01);
  expect(2);
  EXPECT_TRUE(best_.feasible());
  offer(3, 10.0, 0.5, 1e-6);
  expect(2);
}

TEST_F(BestIterateTest, SmallerMeritWinsAmongFeasible) {
  offer(1, 10.0, 5.0, -0.5);
  offer(2, 10.0, 4.0, 0.0);  // on the bound is feasible
  expect(2);
  offer(3, 10.0, 4.5, -0.9);
  expect(2);
  offer(4, 10.0, -30.0, -0.1);  // merits may be negative: logarithms
  expect(4);
}

TEST_F(BestIterateTest, SmallerViolationWinsAmongInfeasible) {
  offer(1, 10.0, 1.0, 0.3);
  offer(2, 10.0, 9.0, 0.2);
  expect(2);
  offer(3, 10.0, 0.1, 0.25);
  expect(2);
}

TEST_F(BestIterateTest, AnotherSharpnessStartsOver) {
  offer(1, 10.0, 1.0, -0.1);
  offer(2, 15.0, 100.0, 0.4);
  expect(2);
  EXPECT_EQ(best_.beta(), 15.0);
  offer(3, 15.0, 200.0, 0.3);
  expect(3);
}

TEST_F(BestIterateTest, EqualOnesKeepTheEarlier) {
  offer(1, 10.0, 1.0, -0.1);
  offer(2, 10.0, 1.0, -0.2);
  expect(1);
}

/// Nothing that is left to vary may change a violation.
TEST_F(BestIterateTest, OfEqualViolationsTakesTheSmallerMerit) {
  offer(1, 10.0, 5.0, 0.3);
  offer(2, 10.0, 4.0, 0.3);
  expect(2);
  offer(3, 10.0, 4.5, 0.3);
  expect(2);
}

TEST_F(BestIterateTest, BinaryLayersJudge) {
  offer(1, 10.0, 1.0, -0.1);
  offer_judged(2, values(7.0, -0.1), values(5.0, -0.2));  // starts over
  expect(2);
  EXPECT_EQ(best_.worst_constraint(), -0.1);
  offer_judged(3, values(3.0, -0.1), values(8.0, -0.2));  // the worse of both merits counts
  expect(2);
  offer_judged(4, values(3.0, -0.1), values(4.0, 0.01));  // constraints of both do
  offer_judged(5, values(3.0, 0.01), values(4.0, -0.1));
  expect(2);
  offer_judged(6, values(9.0, -0.1), values(4.0, -0.1));
  expect(2);
  offer_judged(7, values(5.5, -0.1), values(6.0, -0.1));
  expect(7);
}

/// Layers of whole elements cannot have the volumes of smooth ones.
TEST_F(BestIterateTest, BinaryLayersMayMissConstraintsByAnElement) {
  offer_judged(1, values(1.0, -0.1), values(5.0, 0.02));
  offer_judged(2, values(1.0, -0.1), values(9.0, 0.009));
  expect(2);
  offer_judged(3, values(1.0, -0.1), values(8.0, 0.01));  // both near enough: the merit decides
  expect(3);
  EXPECT_FALSE(best_.feasible());
  EXPECT_EQ(best_.worst_constraint(), 0.01);
  offer_judged(4, values(1.0, 1e-9), values(1.0, 0.001));  // the optimizer's own have to hold
  expect(3);
  offer_judged(5, values(1.0, -0.1), values(20.0, -0.1));  // satisfied beats near
  expect(5);
}

/// Where smooth counts of the machine's limits are too large, the exact checks decide.
TEST_F(BestIterateTest, ChecksJudgeTheMachinesLimits) {
  offer_judged(1, values(1.0, 0.1), values(1.0, -0.1), 0.0);  // another constraint is violated
  offer_judged(2, counted(5.0, 3.0), counted(5.0, 3.0), 0.02);
  expect(2);
  offer_judged(3, counted(1.0, 2.0), counted(1.0, 2.0), 0.03);
  expect(2);
  offer_judged(4, counted(9.0, 4.0), counted(9.0, 4.0), 0.0);
  expect(4);
  offer_judged(5, counted(8.0, 5.0), counted(8.0, 5.0), 0.0);  // both keep the limits: the merit decides
  expect(5);
  EXPECT_FALSE(best_.feasible());
  EXPECT_EQ(best_.worst_constraint(), 5.0);
  offer_judged(6, values(30.0, -0.1), values(30.0, 0.001), 0.0);
  expect(6);
}

/// Exact checks decide, also where the smooth counts hold.
TEST_F(BestIterateTest, WhatFailsExactChecksIsNotSatisfied) {
  offer_judged(1, counted(1.0, -0.1), counted(1.0, -0.1), 0.01);
  EXPECT_FALSE(best_.feasible());
  EXPECT_TRUE(best_.fails_checks());
  offer_judged(2, counted(5.0, 0.5), counted(5.0, 0.5), 0.0);
  expect(2);
  EXPECT_FALSE(best_.fails_checks());
  offer_judged(3, counted(9.0, -0.1), counted(9.0, -0.1), 0.0);
  expect(3);
  EXPECT_TRUE(best_.feasible());
}

}  // namespace
}  // namespace fabseq
