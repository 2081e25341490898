// SPDX-License-Identifier: MIT
/// Interior minima and maxima of the pseudo-time (docs/formulation.md 2.1), on 1 to 4 ranks.
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/machine/marked_elements.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

/// Unit cubes, 5 x 5 x 5.
class InteriorExtremaTest : public testing::Test {
 protected:
  /// Slightly oblique, so that no two neighbours are equal, with other values at given elements.
  std::vector<double> time(const std::vector<std::pair<Index<3>, double>>& changed) const {
    std::vector<double> result;
    for (const int element : on_grid.part.elements()) {
      const Index<3> index = on_grid.grid.owned_elements().index(element);
      result.push_back(0.1 + 0.1 * index[2] + 0.01 * index[0] + 0.001 * index[1]);
      for (const auto& [place, value] : changed)
        if (index == place) result.back() = value;
    }
    return result;
  }
  MarkedElements count(const std::vector<double>& marks) const {
    return count_marked<3>(on_grid.part, marks, std::vector<double>(marks.size(), 1.0), 1,
                           MarkedPlace::earliest);
  }

  const test::PartOnGrid<3> on_grid{{{5.0, 5.0, 5.0}, {5, 5, 5}, 1.0}, test::box({0, 0, 0}, {5, 5, 5})};
};

TEST_F(InteriorExtremaTest, AreNotInPlanarLayers) {
  const InteriorExtrema found = find_interior_extrema<3>(on_grid.part, time({}));
  EXPECT_EQ(count(found.minima).elements, 0);
  EXPECT_EQ(count(found.maxima).elements, 0);  // the top is open
}

TEST_F(InteriorExtremaTest, AreFoundWithTheirPlaces) {
  const auto times = time({{{2, 2, 3}, 0.01}, {{1, 3, 1}, 0.9}, {{0, 0, 0}, 0.0}, {{2, 2, 4}, 0.95}});
  const InteriorExtrema found = find_interior_extrema<3>(on_grid.part, times);
  EXPECT_EQ(count(found.minima).elements, 1);
  EXPECT_EQ(count(found.minima).at, (std::vector<double>{2.5, 2.5, 3.5}));
  EXPECT_EQ(count_interior_minima<3>(on_grid.part, times), 1);
  EXPECT_EQ(count(found.maxima).elements, 1);
  EXPECT_EQ(count(found.maxima).at, (std::vector<double>{1.5, 3.5, 1.5}));
}

}  // namespace
}  // namespace fabseq
