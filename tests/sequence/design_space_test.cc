// SPDX-License-Identifier: MIT
/// The range of the design variables and its unit scale.
#include "fabseq/sequence/sequence.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

/// The optimizer's variable: theta in [0, 1].
TEST(DesignScale, SlopesAndInverses) {
  for (const bool logarithmic : {false, true}) {
    const DesignScale space{1e-3, 2.0, logarithmic};
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

/// Entries are [place][component]; a share may begin within a place.
TEST(DesignSpace, ScaleOfAnEntry) {
  const DesignSpace space{{{0.0, 1.0, false}, {1e-3, 2.0, true}, {-1.0, 1.0, false}}};
  EXPECT_EQ(space.count(), 3);
  for (std::size_t entry = 0; entry < 7; ++entry)
    EXPECT_EQ(&space.of(entry), &space.components[entry % 3]) << entry;
  for (std::size_t first = 0; first < 7; ++first)
    for (std::size_t entry = 0; entry < 4; ++entry)
      EXPECT_EQ(space.from(first).of(entry).lower, space.of(first + entry).lower);
}

}  // namespace
}  // namespace fabseq
