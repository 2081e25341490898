// SPDX-License-Identifier: MIT
/// The range of the design variables and its unit scale.
#include "fabseq/sequence/sequence.h"

#include <gtest/gtest.h>

#include "support/small_parts.h"
#include <cmath>

namespace fabseq {
namespace {

/// The optimizer's variable: theta in [0, 1].
TEST(DesignSpace, SlopesAndInverses) {
  for (const bool logarithmic : {false, true}) {
    const DesignSpace space{1e-3, 2.0, logarithmic};
    EXPECT_DOUBLE_EQ(space.from_unit(0.0), 1e-3);
    EXPECT_DOUBLE_EQ(space.from_unit(1.0), 2.0);
    EXPECT_NEAR(space.from_unit(0.5), logarithmic ? std::sqrt(2e-3) : 0.5 * 2.001, 1e-15);
    for (const double unit : {0.05, 0.3, 0.9}) {
      const double design = space.from_unit(unit);
      EXPECT_NEAR(space.to_unit(design), unit, 1e-14);
      const double slope =
          test::central_difference([&](double step) { return space.from_unit(unit + step); }, 1e-3);
      EXPECT_NEAR(space.slope(design), slope, 1e-8 * slope);
    }
    EXPECT_EQ(space.to_unit(1e-5), 0.0);
    EXPECT_EQ(space.to_unit(3.0), 1.0);
  }
}

}  // namespace
}  // namespace fabseq
