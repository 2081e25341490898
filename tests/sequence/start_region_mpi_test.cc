// SPDX-License-Identifier: MIT
/// Start regions: what is in them, what is free, how far it is, and what is refused (formulation 2.3).
#include "fabseq/sequence/start_region.h"
#include "support/refusal.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
Shape whole_bottom() {
  auto upper = test::odd_domain<Dim>().size;
  upper[Dim - 1] = 0.0;
  return test::box(std::vector<double>(Dim, 0.0), {upper.begin(), upper.end()});
}

/// Of all ranks; there is at least one. Collective.
void expect_all_alike(const std::vector<double>& values) {
  const double low = values.empty() ? INFINITY : *std::min_element(values.begin(), values.end());
  const double high = max(PETSC_COMM_WORLD, test::largest(values));
  EXPECT_GT(high, 0.0);
  EXPECT_NEAR(min(PETSC_COMM_WORLD, low), high, 1e-12);
}

template <class T>
class StartRegionTest : public testing::Test {
 protected:
  const test::PartOnGrid<T::value> on_grid_{test::odd_domain<T::value>(), test::gallows<T::value>()};
  const Part<T::value>& part_ = on_grid_.part;
  const IndexBox<T::value>& elements_ = on_grid_.grid.owned_elements();
  const IndexBox<T::value>& nodes_ = on_grid_.grid.owned_nodes();
};
TYPED_TEST_SUITE(StartRegionTest, test::Dimensions);

/// No element has its centre on the plate: those with a node there count, as without a shape.
TYPED_TEST(StartRegionTest, ElementsAboveThePlate) {
  constexpr int Dim = TypeParam::value;
  for (const auto& shape : {std::optional<Shape>(whole_bottom<Dim>()), std::optional<Shape>()}) {
    const StartRegion region = make_start_region(this->part_, DesignLocation::elements, shape);
    std::size_t next = 0;
    std::vector<double> slopes;  // straight up the column; longer in the arm
    const double height = this->on_grid_.grid.spacing()[Dim - 1];
    for (std::size_t e = 0; e < region.elements.size(); ++e) {
      const Index<Dim> element = this->elements_.index(this->part_.elements()[e]);
      EXPECT_EQ(region.elements[e] != 0, element[Dim - 1] == 0);
      if (element[Dim - 1] == 0) continue;
      EXPECT_EQ(region.free[next], this->part_.elements()[e]);
      if (element[0] < 2) slopes.push_back(region.initial_time[next] / (height * element[Dim - 1]));
      ++next;
    }
    EXPECT_EQ(region.free.size(), next);
    EXPECT_EQ(region.initial_time.size(), next);
    EXPECT_NEAR(max(PETSC_COMM_WORLD, test::largest(region.initial_time)), 1.0, 1e-15);
    expect_all_alike(slopes);
  }
}

TYPED_TEST(StartRegionTest, NodesOnThePlate) {
  constexpr int Dim = TypeParam::value;
  for (const auto& shape : {std::optional<Shape>(whole_bottom<Dim>()), std::optional<Shape>()}) {
    const StartRegion region = make_start_region(this->part_, DesignLocation::nodes, shape);
    std::size_t next = 0;
    this->nodes_.for_each([&](const Index<Dim>& node, std::int64_t offset) {
      if (this->part_.touched_nodes()[offset] == 0 || node[Dim - 1] == 0) return;
      ASSERT_LT(next, region.free.size());
      EXPECT_EQ(region.free[next++], offset);
    });
    EXPECT_EQ(region.free.size(), next);
    // Their lower nodes are fixed, their upper ones not.
    for (const char starts : region.elements) EXPECT_EQ(starts, 0);
  }
}

/// From a corner the distance along an edge is that to the corner.
TYPED_TEST(StartRegionTest, DistanceOfNodesFromACorner) {
  constexpr int Dim = TypeParam::value;
  const std::vector<double> origin(Dim, 0.0);
  const StartRegion region = make_start_region(this->part_, DesignLocation::nodes, test::box(origin, origin));
  const Grid<Dim>& grid = this->on_grid_.grid;
  std::vector<double> times;  // along the upright edge, over the height
  for (std::size_t i = 0; i < region.free.size(); ++i) {
    const Index<Dim> node = this->nodes_.index(region.free[i]);
    bool on_edge = true;
    for (int axis = 0; axis + 1 < Dim; ++axis) on_edge = on_edge && node[axis] == 0;
    if (on_edge) times.push_back(region.initial_time[i] / grid.node_position(node)[Dim - 1]);
  }
  expect_all_alike(times);
  EXPECT_NEAR(max(PETSC_COMM_WORLD, test::largest(region.initial_time)), 1.0, 1e-15);
}

/// A thick region holds elements by their centres, and elements all of whose nodes it holds.
TYPED_TEST(StartRegionTest, ThickRegion) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim>& grid = this->on_grid_.grid;
  auto upper = test::odd_domain<Dim>().size;
  upper[Dim - 1] = 1.6 * grid.spacing()[Dim - 1];  // beyond the second centre, not the second row of nodes
  const Shape shape = test::box(std::vector<double>(Dim, 0.0), {upper.begin(), upper.end()});
  const StartRegion by_centres = make_start_region(this->part_, DesignLocation::elements, shape);
  const StartRegion by_nodes = make_start_region(this->part_, DesignLocation::nodes, shape);
  for (std::size_t e = 0; e < by_centres.elements.size(); ++e) {
    const int level = this->elements_.index(this->part_.elements()[e])[Dim - 1];
    EXPECT_EQ(by_centres.elements[e] != 0, level <= 1);
    EXPECT_EQ(by_nodes.elements[e] != 0, level == 0);
  }
}

/// The same on any number of ranks.
TYPED_TEST(StartRegionTest, DoesNotDependOnTheRanks) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> alone(test::odd_domain<Dim>(), test::gallows<Dim>(), {Dim - 1, false},
                                    PETSC_COMM_SELF);
  const std::vector<double> origin(Dim, 0.0);
  const Shape corner = test::box(origin, origin);
  const auto on_nodes = [](const Part<Dim>& part, const StartRegion& region) {
    std::vector<double> field(part.touched_nodes().size(), 0.0);
    for (std::size_t i = 0; i < region.free.size(); ++i) field[region.free[i]] = region.initial_time[i];
    return test::whole_node_field<Dim>(part.grid(), field);
  };
  const auto parallel = on_nodes(this->part_, make_start_region(this->part_, DesignLocation::nodes, corner));
  const auto serial = on_nodes(alone.part, make_start_region(alone.part, DesignLocation::nodes, corner));
  EXPECT_LT(test::relative_difference(parallel, serial), 1e-12);
}

TYPED_TEST(StartRegionTest, RefusesWhatIsNoStart) {
  constexpr int Dim = TypeParam::value;
  const auto size = test::odd_domain<Dim>().size;
  const std::vector<double> zero(Dim, 0.0), far(size.begin(), size.end());
  std::vector<double> beyond = far;
  for (double& x : beyond) x += 1.0;
  const auto message = [&](DesignLocation location, const Shape& shape) {
    return test::refusal([&] { (void)make_start_region(this->part_, location, shape); });
  };
  for (const DesignLocation location : {DesignLocation::elements, DesignLocation::nodes}) {
    EXPECT_NE(message(location, test::box(beyond, beyond)).find("/sequence/start: no "), std::string::npos);
    EXPECT_NE(message(location, test::box(zero, far)).find("/sequence/start: holds all "), std::string::npos);
  }
}

/// Two towers that stand apart: one of them is never reached from the other.
TYPED_TEST(StartRegionTest, RefusesWhatCannotBeReached) {
  constexpr int Dim = TypeParam::value;
  Domain<Dim> domain;
  domain.size.fill(1.0);
  domain.elements.fill(3);
  domain.elements[0] = 5;
  std::vector<double> low(Dim, 0.0), high(Dim, 1.0), left = high, right = low;
  left[0] = 0.4;
  right[0] = 0.6;
  const test::PartOnGrid<Dim> towers(domain, test::union_of({test::box(low, left), test::box(right, high)}));
  for (const DesignLocation location : {DesignLocation::elements, DesignLocation::nodes}) {
    const std::string text =
        test::refusal([&] { (void)make_start_region(towers.part, location, test::box(low, low)); });
    EXPECT_NE(text.find("/sequence/start: "), std::string::npos) << text;
    EXPECT_NE(text.find("cannot be reached"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace fabseq
