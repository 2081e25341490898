// SPDX-License-Identifier: MIT
/// What the torch cannot reach (docs/formulation.md 13.1): cases by hand, and every element against every
/// other on small random parts, on 1 to 4 ranks.
#include "fabseq/machine/blocked.h"
#include "fabseq/machine/marked_elements.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fabseq {
namespace {

using test::box;
using test::PartOnGrid;

ToolSettings tool(std::vector<std::array<double, 2>> profile, double clearance = 0.0) {
  ToolSettings settings;
  settings.profile = std::move(profile);
  settings.clearance = clearance;
  return settings;
}

/// The layer of each part element: its index along an axis, from 1.
template <int Dim>
std::vector<double> layers_along(const Part<Dim>& part, int axis) {
  std::vector<double> result;
  for (const int element : part.elements())
    result.push_back(part.grid().owned_elements().index(element)[axis] + 1.0);
  return result;
}

/// Depths for a torch with a fixed axis, on the whole grid; 0 outside the part.
template <int Dim>
std::vector<double> depths(const Part<Dim>& part, ToolSettings settings, std::vector<double> axis,
                           const std::vector<double>& layer) {
  settings.axis = std::move(axis);
  const std::vector<double> axes = torch_axis<Dim>(part, settings, {});
  return test::whole_part_field<Dim>(part, blocked_depth<Dim>(part, Torch(settings), axes, layer));
}

double at(const Grid<3>& grid, const std::vector<double>& field, const Index<3>& element) {
  return field[grid.all_elements().offset(element)];
}

/// A step: the lower half is built last. Unit cubes, 4 x 1 x 4.
TEST(BlockedTest, AStepThatOverhangs) {
  const PartOnGrid<3> step({{4.0, 1.0, 4.0}, {4, 1, 4}, 1.0}, box({0, 0, 0}, {4, 1, 4}));
  const Grid<3>& grid = step.grid;
  std::vector<double> layer;  // columns 0 and 1 first
  for (const int element : step.part.elements())
    layer.push_back(grid.owned_elements().index(element)[0] < 2 ? 1.0 : 2.0);
  // A cylinder of radius 1.5 that begins 0.5 above the tip.
  const auto found = depths<3>(step.part, tool({{0.5, 1.5}, {10.0, 1.5}}), {0, 0, 1}, layer);
  for (int z = 0; z < 4; ++z) {
    EXPECT_EQ(at(grid, found, {0, 0, z}), 0.0);
    EXPECT_EQ(at(grid, found, {1, 0, z}), 0.0);
    EXPECT_EQ(at(grid, found, {2, 0, z}), z < 3 ? 0.5 : 0.0) << z;  // column 1 stands 1 beside it
    EXPECT_EQ(at(grid, found, {3, 0, z}), 0.0);                     // 2 away from column 1
  }
  const auto wide = depths<3>(step.part, tool({{0.5, 1.5}, {10.0, 1.5}}, 0.75), {0, 0, 1}, layer);
  EXPECT_EQ(at(grid, wide, {3, 0, 0}), 0.25);
  EXPECT_EQ(at(grid, wide, {2, 0, 0}), 1.25);
}

/// A cone reaches into a slot as deep as its flank allows. Unit cubes, walls of 6 elements around a slot that
/// is 3 wide.
TEST(BlockedTest, AToolTooWideForASlot) {
  const PartOnGrid<3> on_grid({{5.0, 1.0, 6.0}, {5, 1, 6}, 1.0}, box({0, 0, 0}, {5, 1, 6}));
  std::vector<double> layer;  // walls at x = 0 and 4 first, then the filling
  for (const int element : on_grid.part.elements()) {
    const int x = on_grid.grid.owned_elements().index(element)[0];
    layer.push_back(x == 0 || x == 4 ? 1.0 : 2.0);
  }
  const auto found = depths<3>(on_grid.part, tool({{0.0, 0.0}, {2.0, 1.0}, {6.0, 3.0}}), {0, 0, 1}, layer);
  for (int z = 0; z < 6; ++z) {
    const double highest = 5.0 - z;  // of the walls above the tip: radius half the height
    EXPECT_NEAR(at(on_grid.grid, found, {2, 0, z}), std::max(0.0, 0.5 * highest - 2.0), 1e-12) << z;
    EXPECT_NEAR(at(on_grid.grid, found, {1, 0, z}), std::max(0.0, 0.5 * highest - 1.0), 1e-12) << z;
  }
}

TEST(BlockedTest, ASubstrateIsInTheWayAndThePlateIsNot) {
  PartDescription description{box({2, 0, 0}, {4, 1, 4}), false};
  description.substrate = box({0, 0, 0}, {2, 1, 4});
  const PartOnGrid<3> on_grid({{4.0, 1.0, 4.0}, {4, 1, 4}, 1.0}, description);
  const auto found =
      depths<3>(on_grid.part, tool({{0.0, 1.25}, {8.0, 1.25}}), {0, 0, 1}, layers_along(on_grid.part, 2));
  for (int z = 0; z < 4; ++z) {
    EXPECT_EQ(at(on_grid.grid, found, {2, 0, z}), 0.25);
    EXPECT_EQ(at(on_grid.grid, found, {3, 0, z}), 0.0);
  }
}

/// Planar layers at 45 degrees, the torch across them and upright.
TEST(BlockedTest, ATiltedPlanarSequenceAndItsTilt) {
  const PartOnGrid<2> on_grid({{8.0, 8.0}, {8, 8}, 1.0}, box({0, 0}, {8, 8}));
  const Part<2>& part = on_grid.part;
  std::vector<double> layer;
  for (const int element : part.elements()) {
    const Index<2> index = on_grid.grid.owned_elements().index(element);
    layer.push_back(index[0] + index[1] + 1.0);
  }
  // Across the layers, everything earlier lies below the tip.
  const ToolSettings flat = tool({{0.0, 5.0}, {20.0, 5.0}});
  for (const double depth : depths<2>(part, flat, {1, 1}, layer)) EXPECT_EQ(depth, 0.0);
  // Upright, the element one to the left and one up is of the same layer, that two to the left and one up
  // is earlier: 2 away from the axis.
  const auto upright = depths<2>(part, flat, {0, 1}, layer);
  const IndexBox<2> whole = on_grid.grid.all_elements();
  EXPECT_EQ(upright[whole.offset({4, 0})], 5.0 - 1.0);  // at the tip's own height the next to the left counts
  EXPECT_EQ(upright[whole.offset({0, 4})], 0.0);
  const ToolSettings raised = tool({{0.5, 5.0}, {20.0, 5.0}});
  EXPECT_EQ(depths<2>(part, raised, {0, 1}, layer)[whole.offset({4, 0})], 5.0 - 2.0);

  ToolSettings tilted = flat;
  tilted.axis = {3.0, 3.0};
  for (const double angle : torch_tilt<2>(part, torch_axis<2>(part, tilted, {})))
    EXPECT_NEAR(angle, 45.0, 1e-12);
}

TEST(TorchTest, AStepOfTheProfileHasBothRadii) {
  const Torch torch(tool({{1.0, 2.0}, {3.0, 2.0}, {3.0, 5.0}, {4.0, 1.0}}, 0.5));
  EXPECT_EQ(torch.radius(0.99), -INFINITY);
  EXPECT_EQ(torch.radius(1.0), 2.5);
  EXPECT_EQ(torch.radius(3.0), 5.5);
  EXPECT_EQ(torch.radius(3.5), 3.5);
  EXPECT_EQ(torch.radius(4.0), 1.5);
  EXPECT_EQ(torch.radius(4.01), -INFINITY);
  EXPECT_EQ(torch.largest_radius(0.0, 2.0), 2.5);
  EXPECT_EQ(torch.largest_radius(2.0, 9.0), 5.5);
  EXPECT_EQ(torch.largest_radius(3.5, 9.0), 3.5);
  EXPECT_EQ(torch.reach(), std::hypot(3.0, 5.5));
}

TEST(TorchTest, WithoutABuildDirectionItStandsOnThePlate) {
  const PartOnGrid<2> on_grid(test::odd_domain<2>(), test::block<2>(), {1, true});
  const std::vector<double> none(on_grid.part.elements().size() * 2, 0.0);
  const std::vector<double> axis = torch_axis<2>(on_grid.part, {}, none);
  for (std::size_t i = 0; i < axis.size(); ++i) EXPECT_EQ(axis[i], i % 2 == 0 ? 0.0 : -1.0);
  EXPECT_TRUE(torch_axis<2>(on_grid.part, {}, {}).empty());
}

/// The definition, every element against every other, on whole fields.
template <int Dim>
double deepest(const Grid<Dim>& grid, const std::vector<double>& layer, const Index<Dim>& element,
               const double* axis, const ToolSettings& settings) {
  double result = 0.0;
  grid.all_elements().for_each([&](const Index<Dim>& other, std::int64_t number) {
    if (layer[number] >= layer[grid.all_elements().offset(element)]) return;
    double height = 0.0, square = 0.0;
    for (int i = 0; i < Dim; ++i) height += (other[i] - element[i]) * grid.spacing()[i] * axis[i];
    for (int i = 0; i < Dim; ++i)
      square += std::pow((other[i] - element[i]) * grid.spacing()[i] - height * axis[i], 2);
    for (std::size_t k = 1; k < settings.profile.size(); ++k) {
      const auto [low, low_radius] = settings.profile[k - 1];
      const auto [high, high_radius] = settings.profile[k];
      if (height < low || height > high) continue;
      const double radius = low_radius + (high_radius - low_radius) * (height - low) / (high - low);
      result = std::max(result, radius + settings.clearance - std::sqrt(square));
    }
  });
  return result;
}

template <class Dimension>
class BlockedOnAnyRanksTest : public testing::Test {};
TYPED_TEST_SUITE(BlockedOnAnyRanksTest, test::Dimensions);

TYPED_TEST(BlockedOnAnyRanksTest, IsWhatTheDefinitionSays) {
  constexpr int Dim = TypeParam::value;
  PartDescription description{test::gallows<Dim>(), false};
  const auto size = test::odd_domain<Dim>().size;
  description.substrate = box(std::vector<double>(Dim, 0.0), {0.4 * size[0], size[1], size[Dim - 1]});
  description.substrate->second[Dim - 1] = 0.25 * size[Dim - 1];
  Domain<Dim> domain = test::odd_domain<Dim>();
  for (int& count : domain.elements) count *= 2;
  const PartOnGrid<Dim> on_grid(domain, description);
  const Part<Dim>& part = on_grid.part;
  const Grid<Dim>& grid = part.grid();
  const ToolSettings settings = tool({{0.1, 0.05}, {0.6, 0.2}, {1.1, 0.7}}, 0.03);

  std::vector<double> layer, axis;
  for (const int element : part.elements()) {  // the same on any ranks
    const Index<Dim> index = grid.owned_elements().index(element);
    std::mt19937 random(static_cast<unsigned>(grid.all_elements().offset(index)));
    layer.push_back(1.0 + static_cast<double>(random() % 6));
    double square = 0.0;
    for (int i = 0; i < Dim; ++i) {
      axis.push_back(std::uniform_real_distribution<>(-1.0, 1.0)(random));
      square += axis.back() * axis.back();
    }
    for (int i = 0; i < Dim; ++i) axis[axis.size() - Dim + i] /= std::sqrt(square);
  }
  std::vector<double> built = part.expand(layer, 1e9);
  for (std::size_t element = 0; element < built.size(); ++element)
    if (part.substrate().elements()[element] != 0) built[element] = 0.0;
  const std::vector<double> whole = test::whole_element_field(grid, built);

  const std::vector<double> found = blocked_depth<Dim>(part, Torch(settings), axis, layer);
  double largest = 0.0;
  for (std::size_t e = 0; e < found.size(); ++e) {
    const Index<Dim> index = grid.owned_elements().index(part.elements()[e]);
    EXPECT_NEAR(found[e], deepest<Dim>(grid, whole, index, &axis[e * Dim], settings), 1e-9);
    largest = std::max(largest, found[e]);
  }
  const MarkedElements count = count_marked<Dim>(part, found, layer, 6, MarkedPlace::largest);
  EXPECT_EQ(count.largest, max(grid.comm(), largest));
  EXPECT_GT(count.elements, 0);
  EXPECT_LT(count.elements, part.count());
}

}  // namespace
}  // namespace fabseq
