// SPDX-License-Identifier: MIT
/// The drain's characteristic length: a bar's is the height of its layers, a part on a narrow foot has a
/// longer one, with which the foot needs no more than admissible diffusivities.
#include "sequence/drain_length.h"
#include "sequence/heat_sequence.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

using test::box;
using test::union_of;

double length_of(const Shape& shape, double height, const HeatSettings& settings = {}) {
  const Domain<2> domain{{6.0, 4.0}, {48, 32}, 1.0};
  const PartDescription description{shape, false};
  const Grid<2> grid = make_balanced_grid<2>(PETSC_COMM_WORLD, domain, description);
  return drain_length<2>(Part<2>(grid, description, {1, false}), settings, height);
}

TEST(DrainLength, OfABarIsTheHeightOfItsLayers) {
  EXPECT_EQ(length_of(box({2, 0}, {4, 4}), 4.0), 4.0);
  EXPECT_EQ(length_of(union_of({box({1, 0}, {5, 1}), box({2, 1}, {3, 4})}), 4.0), 4.0);  // narrow above
}

TEST(DrainLength, GrowsWithWhatIsAboveANarrowFoot) {
  // A foot as wide and as high as a slice of two elements, below a wall six times as wide: with layers of 8
  // in all, the foot passes 6 times the integral of 1 - s/8 from 0.25 to 4, divided by 8.
  const Shape part = union_of({box({2.5, 0}, {3, 0.25}), box({1.5, 0.25}, {4.5, 4})});
  const double length = length_of(part, 8.0);
  EXPECT_GT(length, 8.0);
  const double straight = 6.0 / 8.0 * (3.75 - (16.0 - 0.0625) / 16.0);
  EXPECT_NEAR(length, 8.0 * std::sqrt(straight / 0.75), 0.15 * length);  // paths to the sides are longer
  HeatSettings weak;
  weak.drain = 0.1;
  EXPECT_EQ(length_of(part, 8.0, weak), 8.0);
  HeatSettings half;
  half.max_diffusivity = 0.5;
  EXPECT_NEAR(length_of(part, 8.0, half), length * std::sqrt(2.0), 1e-12 * length);
}

}  // namespace
}  // namespace fabseq
