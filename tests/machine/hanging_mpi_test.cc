// SPDX-License-Identifier: MIT
/// Elements that begin in the air (docs/formulation.md 13.1), on 1 to 4 ranks.
#include "fabseq/machine/hanging.h"
#include "fabseq/machine/marked_elements.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace fabseq {
namespace {

using test::box;
using test::PartOnGrid;

/// A column of 2 x 2 elements with a bar on top of it: unit cubes, 8 x 2 x 6.
const Domain<3> crane_domain{{8.0, 2.0, 6.0}, {8, 2, 6}, 1.0};
Shape crane() { return test::union_of({box({0, 0, 0}, {2, 2, 4}), box({0, 0, 4}, {8, 2, 6})}); }

/// The height of each part element in the layers of a plane cut, from 1.
std::vector<double> layers_along(const Part<3>& part, int axis) {
  std::vector<double> result;
  for (const int element : part.elements())
    result.push_back(part.grid().owned_elements().index(element)[axis] + 1.0);
  return result;
}

MarkedElements hanging_of(const Part<3>& part, const std::vector<double>& direction,
                          const std::vector<double>& layer, double bead_width = 0.0) {
  return count_marked<3>(part, hanging_elements<3>(part, direction, layer, bead_width), layer, 8,
                         MarkedPlace::earliest);
}

TEST(HangingTest, NothingHangsInABlockOnThePlate) {
  for (const BuildPlate plate : {BuildPlate{2, false}, BuildPlate{2, true}}) {
    const PartOnGrid<3> block(crane_domain, box({0, 0, 0}, {8, 2, 6}), plate);
    std::vector<double> layer = layers_along(block.part, 2);
    if (plate.upper)
      for (double& number : layer) number = 7.0 - number;
    const MarkedElements found = hanging_of(block.part, {}, layer);
    EXPECT_EQ(found.elements, 0);
    EXPECT_TRUE(found.at.empty());
  }
}

TEST(HangingTest, TheUndersideOfABarHangsWherePlanarLayersLeaveTheColumn) {
  const PartOnGrid<3> on_grid(crane_domain, crane());
  const Part<3>& part = on_grid.part;
  const MarkedElements found = hanging_of(part, {}, layers_along(part, 2));
  EXPECT_EQ(found.elements, 5 * 2);  // one column of elements may lean out
  EXPECT_EQ(found.per_layer, (std::vector<std::int64_t>{0, 0, 0, 0, 10, 0, 0, 0}));
  EXPECT_EQ(found.at, (std::vector<double>{3.5, 0.5, 4.5}));
  EXPECT_DOUBLE_EQ(found.share, 10.0 / 48.0);
  // A bead of six elements' width rests on the column with half of it.
  EXPECT_EQ(hanging_of(part, {}, layers_along(part, 2), 6.0).elements, 3 * 2);
  // One that is wider than the box reaches everything in it, and no further.
  EXPECT_EQ(hanging_of(part, {}, layers_along(part, 2), 5e8).elements, 0);
}

TEST(HangingTest, TheBarStandsOnTheColumnIfItIsBuiltSideways) {
  const PartOnGrid<3> on_grid(crane_domain, crane());
  const Part<3>& part = on_grid.part;
  std::vector<double> layer, direction;
  for (const int element : part.elements()) {
    const Index<3> index = part.grid().owned_elements().index(element);
    const bool sideways = index[0] >= 2;
    layer.push_back(sideways ? index[0] : 1.0);
    direction.insert(direction.end(), {sideways ? 1.0 : 0.0, 0.0, sideways ? 0.0 : 1.0});
  }
  EXPECT_EQ(hanging_of(part, direction, layer).elements, 0);
}

/// The definition, element by element, on whole fields.
template <int Dim>
bool stands(const Grid<Dim>& grid, const std::vector<double>& layer, const Index<Dim>& element,
            const double* direction, double radius) {
  double extent = 0.0;
  for (int axis = 0; axis < Dim; ++axis) extent += std::abs(direction[axis]) * grid.spacing()[axis];
  IndexBox<Dim> around = grid.all_elements();
  for (int axis = 0; axis < Dim; ++axis) {  // with what lies below the plate
    around.start[axis] -= 5;
    around.size[axis] += 10;
  }
  bool found = false;
  around.for_each([&](const Index<Dim>& other, std::int64_t) {
    double along = 0.0, square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) {
      const double offset = (other[axis] - element[axis]) * grid.spacing()[axis];
      along -= offset * direction[axis];
      square += offset * offset;
    }
    if (along < 0.499999 * extent || along > 1.000001 * extent || square - along * along > radius * radius)
      return;
    const bool below_plate = other[Dim - 1] < 0;
    const bool inside = grid.all_elements().contains(other);
    found =
        found || below_plate ||
        (inside && layer[grid.all_elements().offset(other)] <= layer[grid.all_elements().offset(element)]);
  });
  return found;
}

template <class Dimension>
class HangingOnAnyRanksTest : public testing::Test {};
TYPED_TEST_SUITE(HangingOnAnyRanksTest, test::Dimensions);

TYPED_TEST(HangingOnAnyRanksTest, MarksWhatTheDefinitionSays) {
  constexpr int Dim = TypeParam::value;
  PartDescription description{test::gallows<Dim>(), false};
  const auto size = test::odd_domain<Dim>().size;
  description.substrate = box(std::vector<double>(Dim, 0.0), {0.4 * size[0], size[1], size[Dim - 1]});
  description.substrate->second[Dim - 1] = 0.25 * size[Dim - 1];
  const PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), description);
  const Part<Dim>& part = on_grid.part;
  const Grid<Dim>& grid = part.grid();

  std::vector<double> layer, direction;
  for (const int element : part.elements()) {  // the same on any ranks
    const Index<Dim> index = grid.owned_elements().index(element);
    std::mt19937 random(static_cast<unsigned>(grid.all_elements().offset(index)));
    layer.push_back(1.0 + static_cast<double>(random() % 6));
    Point<Dim> axis{};
    double square = 0.0;
    for (double& component : axis) {
      component = std::uniform_real_distribution<>(-1.0, 1.0)(random);
      square += component * component;
    }
    for (const double component : axis) direction.push_back(component / std::sqrt(square));
  }
  std::vector<double> built = part.expand(layer, 1e9);
  for (std::size_t element = 0; element < built.size(); ++element)
    if (part.substrate().elements()[element] != 0) built[element] = 0.0;
  const std::vector<double> whole = test::whole_element_field(grid, built);

  const double width = 2.5 * grid.largest_spacing();
  const std::vector<double> marks = hanging_elements<Dim>(part, direction, layer, width);
  std::int64_t hanging = 0;
  for (std::size_t e = 0; e < marks.size(); ++e) {
    const Index<Dim> index = grid.owned_elements().index(part.elements()[e]);
    EXPECT_EQ(marks[e] == 0.0, stands<Dim>(grid, whole, index, &direction[e * Dim], 0.5 * width))
        << to_text<Dim>(index);
    hanging += marks[e] != 0.0 ? 1 : 0;
  }
  const MarkedElements count = count_marked<Dim>(part, marks, layer, 6, MarkedPlace::earliest);
  EXPECT_EQ(count.elements, sum(grid.comm(), hanging));
  EXPECT_GT(count.elements, 0);
  EXPECT_EQ(std::accumulate(count.per_layer.begin(), count.per_layer.end(), std::int64_t{0}), count.elements);
}

}  // namespace
}  // namespace fabseq
