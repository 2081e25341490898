// SPDX-License-Identifier: MIT
/// Limits that follow the exact checks (docs/developer/repair.md 13.2).
#include "fabseq/optimize/adaptive_limits.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

TEST(AdaptiveLimitsTest, BecomeStricterWhereTheCheckFailsWithinReach) {
  AdaptiveLimits limits(2);
  limits.adapt(1, 0.2, 0.01, true);
  EXPECT_EQ(limits.factors(), (std::vector<double>{1.0, 0.85}));
  limits.adapt(1, 0.4, 0.01, true);
  EXPECT_EQ(limits.factor(1), 0.85) << "not reached yet";
}

TEST(AdaptiveLimitsTest, BecomeWiderWhereTheCheckHoldsAndTheCountCosts) {
  AdaptiveLimits limits(1);
  limits.adapt(0, 5.0, 0.0, true);
  EXPECT_EQ(limits.factor(0), 1.1);
  limits.adapt(0, -0.4, 0.0, true);
  EXPECT_EQ(limits.factor(0), 1.1) << "kept by far";
}

TEST(AdaptiveLimitsTest, StayWhereTheyMayNotWiden) {
  AdaptiveLimits limits(1);
  limits.adapt(0, 5.0, 0.0, false);
  EXPECT_EQ(limits.factor(0), 1.0);
  limits.adapt(0, 0.0, 0.1, false);
  EXPECT_EQ(limits.factor(0), 0.85);
}

TEST(AdaptiveLimitsTest, ChangeByNoMoreThanAFactor) {
  AdaptiveLimits limits(2);
  for (int i = 0; i < 200; ++i) {
    limits.adapt(0, 1.0, 0.0, true);
    limits.adapt(1, 0.0, 1.0, true);
  }
  EXPECT_EQ(limits.factor(0), 1e4);
  EXPECT_EQ(limits.factor(1), 1e-4);
}

TEST(AdaptiveLimitsTest, AreSaved) {
  AdaptiveLimits limits(2), others(2);
  limits.adapt(0, 0.0, 0.5, true);
  CheckpointState state;
  limits.save(state);
  others.restore(state);
  EXPECT_EQ(limits.factors(), others.factors());
}

}  // namespace
}  // namespace fabseq
