// SPDX-License-Identifier: MIT
/// Distances on paths inside the part: exact where the scheme is, near exact paths around corners, and equal
/// to one rank's.
#include "fabseq/base/mpi.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "support/shapes.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fabseq {
namespace {

using test::box;
using test::combine;
using test::union_of;

template <int Dim>
std::vector<double> whole_distance(MPI_Comm comm, const Domain<Dim>& domain, const Shape& shape,
                                   const BuildPlate& plate) {
  const PartDescription description{shape, false};
  const Grid<Dim> grid = make_balanced_grid<Dim>(comm, domain, description);
  const Part<Dim> part(grid, description, plate);
  return test::whole_element_field<Dim>(grid, part.expand(geodesic_distance<Dim>(part), -1.0));
}

TEST(GeodesicDistance, IsExactAboveAColumnAndAPlate) {
  const Domain<3> domain{{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0};
  const IndexBox<3> all{{}, domain.elements};
  for (const Shape& shape : {box({0.4, 0.3, 0}, {0.6, 0.6, 2.5}), box({0, 0, 0}, {1.4, 0.9, 2.5})}) {
    const std::vector<double> distance = whole_distance<3>(PETSC_COMM_WORLD, domain, shape, {2, false});
    all.for_each([&](const Index<3>& element, std::int64_t e) {
      if (distance[e] < 0.0) return;
      EXPECT_NEAR(distance[e], (element[2] + 0.5) * 0.5, 1e-14);
    });
  }
  const std::vector<double> hanging =
      whole_distance<3>(PETSC_COMM_WORLD, domain, box({0, 0, 0}, {1.4, 0.9, 2.5}), {0, true});
  all.for_each([&](const Index<3>& element, std::int64_t e) {
    EXPECT_NEAR(hanging[e], (6.5 - element[0]) * 0.2, 1e-14);
  });
}

TEST(GeodesicHeight, IsTheFarSideOfTheFarthestElement) {
  const Domain<2> domain{{3.5, 0.6}, {7, 3}, 1.0};
  const Grid<2> grid(PETSC_COMM_WORLD, domain, nullptr);
  const Part<2> part(grid, {box({0, 0}, {3.5, 0.4}), false}, {1, false});
  EXPECT_NEAR(geodesic_height<2>(part, geodesic_distance<2>(part)), 0.4, 1e-14);
}

/// A bridge on one leg: up 2 in the left leg, over a gap of 1, down the right leg, which ends at 0.2 above
/// the plate.
template <int Dim>
Shape arch() {
  if constexpr (Dim == 2)
    return union_of({box({0, 0}, {1, 3}), box({0, 2}, {3, 3}), box({2, 0.25}, {3, 3})});
  else
    return union_of({box({0, 0, 0}, {1, 1, 3}), box({0, 0, 2}, {3, 1, 3}), box({2, 0, 0.25}, {3, 1, 3})});
}

/// Length of the shortest path from the plate to a point of the arch (x along, z up).
double arch_path(double x, double z) {
  if (x <= 1.0) return z;
  const double corner = 2.0;  // up along the inner edge of the left leg
  if (z >= 2.0) return corner + std::hypot(x - 1.0, z - 2.0);
  return corner + 1.0 + std::hypot(x - 2.0, 2.0 - z);  // around both inner corners
}

template <int Dim>
double worst_error(const Domain<Dim>& domain) {
  const std::vector<double> distance =
      whole_distance<Dim>(PETSC_COMM_WORLD, domain, arch<Dim>(), {Dim - 1, false});
  double worst = 0.0;
  IndexBox<Dim>{{}, domain.elements}.for_each([&](const Index<Dim>& element, std::int64_t e) {
    if (distance[e] < 0.0) return;
    const Point<Dim> center = domain.element_center(element);
    const double exact = arch_path(center[0], center[Dim - 1]);
    worst = std::max(worst, std::abs(distance[e] - exact) / exact);
  });
  return worst;
}

TEST(GeodesicDistance, GoesAroundAnObstacle) {
  EXPECT_LT(worst_error<2>({{3, 3}, {48, 36}, 1.0}), 0.10);
  EXPECT_LT(worst_error<3>({{3, 1, 3}, {24, 4, 36}, 1.0}), 0.10);
}

TEST(GeodesicDistance, ConvergesWithTheGrid) {
  const double coarse = worst_error<2>({{3, 3}, {24, 36}, 1.0});
  const double fine = worst_error<2>({{3, 3}, {96, 144}, 1.0});
  EXPECT_LT(fine, 0.5 * coarse);
  EXPECT_LT(fine, 0.04);
}

template <int Dim>
void compare_with_one_rank(const Domain<Dim>& domain, const Shape& shape) {
  const BuildPlate plate{Dim - 1, false};
  const std::vector<double> parallel = whole_distance<Dim>(PETSC_COMM_WORLD, domain, shape, plate);
  const std::vector<double> serial = whole_distance<Dim>(PETSC_COMM_SELF, domain, shape, plate);
  for (std::size_t e = 0; e < serial.size(); ++e)
    EXPECT_NEAR(parallel[e], serial[e], 1e-12 * std::abs(serial[e])) << e;
}

TEST(GeodesicDistance, DoesNotDependOnTheRanks) {
  compare_with_one_rank<2>({{3, 3}, {48, 60}, 1.0}, arch<2>());
  compare_with_one_rank<3>({{3, 1, 3}, {18, 7, 24}, 1.0}, arch<3>());
  // A block with a slanted slot: fronts meet from several sides.
  Shape slot;
  slot.kind = Shape::Kind::cylinder;
  slot.first = {0.3, -1.0, 1.0};
  slot.second = {2.5, 2.0, 1.4};
  slot.radius = 0.55;
  compare_with_one_rank<3>({{3, 1, 3}, {21, 9, 18}, 1.0},
                           combine(Shape::Kind::difference, {box({0, 0, 0}, {3, 1, 3}), slot}));
}

/// Nodes are reached along the edges of the part only, elements across its faces; both from anywhere.
TEST(GeodesicDistance, FromAnotherPlace) {
  // An L of one element: 6 to the right, then 4 up.
  const Domain<2> domain{{6, 5}, {6, 5}, 1.0};
  const PartDescription description{union_of({box({0, 0}, {6, 1}), box({5, 0}, {6, 5})}), false};
  const Grid<2> grid = make_balanced_grid<2>(PETSC_COMM_WORLD, domain, description);
  const Part<2> part(grid, description, {1, false});
  std::vector<char> start;
  for (const int element : part.elements())
    start.push_back(grid.owned_elements().index(element)[1] == 4 ? 1 : 0);
  const auto of_elements = geodesic_distance_of_elements<2>(part, start);
  for (std::size_t e = 0; e < of_elements.size(); ++e) {
    const Index<2> element = grid.owned_elements().index(part.elements()[e]);
    EXPECT_NEAR(of_elements[e], (4 - element[1]) + (5 - element[0]), 1e-12);
  }
  std::vector<char> top(static_cast<std::size_t>(grid.owned_nodes().count()), 0);
  grid.owned_nodes().for_each([&](const Index<2>& node, std::int64_t n) {
    top[n] = node[1] == 5 && part.touched_nodes()[n] != 0 ? 1 : 0;
  });
  const auto of_nodes = geodesic_distance_of_nodes<2>(part, top);
  grid.owned_nodes().for_each([&](const Index<2>& node, std::int64_t n) {
    if (part.touched_nodes()[n] == 0) {
      EXPECT_TRUE(std::isinf(of_nodes[n]));
    } else if (node[0] >= 5) {
      EXPECT_NEAR(of_nodes[n], 5 - node[1], 1e-12);  // straight down
    } else if (node[1] == 1) {
      EXPECT_NEAR(of_nodes[n], 4 + 5 - node[0], 1e-12);  // along the inner edge from the inner corner
    } else {
      EXPECT_GT(of_nodes[n], 4 + 5 - node[0]);
    }
  });
}

TEST(GeodesicDistance, FollowsAMeander) {
  // Channels of one element that run to and fro through all ranks: the path is a chain, its length the number
  // of steps.
  constexpr int columns = 20, rows = 11;
  std::vector<Shape> channels = {box({0, 0}, {1, 1})};
  for (int row = 0; row < rows; row += 2) channels.push_back(box({0, 1.0 + row}, {columns, 2.0 + row}));
  for (int row = 1; row < rows; row += 2) {
    const double x = row % 4 == 1 ? columns - 1.0 : 0.0;
    channels.push_back(box({x, 1.0 + row}, {x + 1.0, 2.0 + row}));
  }
  const Domain<2> domain{{columns, rows + 1.0}, {columns, rows + 1}, 1.0};
  const std::vector<double> distance =
      whole_distance<2>(PETSC_COMM_WORLD, domain, union_of(channels), {1, false});
  // 6 channels of 20 and 5 links, in steps of 1; each element has one upwind neighbour only, so no corner is
  // cut.
  const double farthest = *std::max_element(distance.begin(), distance.end());
  EXPECT_NEAR(farthest, 0.5 + 6 * columns + 5, 1e-9);
}

}  // namespace
}  // namespace fabseq
