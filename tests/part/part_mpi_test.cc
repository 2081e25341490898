// SPDX-License-Identifier: MIT
/// Parts: pieces against a serial union-find, refusals, extents, touched nodes, balance.
#include "fabseq/base/mpi.h"
#include "fabseq/part/part.h"
#include "support/refusal.h"
#include "support/shapes.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>

namespace fabseq {
namespace {

using test::box;
using test::refusal;
using test::union_of;

const BuildPlate bottom{2, false};

template <int Dim>
std::string part_refusal(const Domain<Dim>& domain, const Shape& shape, const BuildPlate& plate,
                         bool keep = false) {
  const Grid<Dim> grid(PETSC_COMM_WORLD, domain, nullptr);
  return refusal([&] { Part<Dim>(grid, {shape, keep}, plate); });
}

const Domain<3> unit_elements{{7.0, 3.0, 5.0}, {7, 3, 5}, 1.0};
/// A base, one block of 2 x 1 x 2 elements and one of 3 x 1 x 1 in the air.
const Shape three_blobs =
    union_of({box({0, 0, 0}, {7, 3, 1}), box({0, 0, 2}, {2, 1, 4}), box({4, 2, 3}, {7, 3, 4})});

TEST(Part, RefusesHangingPiecesAndSaysWhere) {
  EXPECT_EQ(
      part_refusal<3>(unit_elements, three_blobs, bottom),
      "/part: 2 pieces are not connected to the build plate: 4 elements in [0,0,2]..[2,1,4], 3 elements in "
      "[4,2,3]..[7,3,4]; set part.keep to \"connected\" to drop them");
}

TEST(Part, DropsHangingPiecesIfAsked) {
  const Grid<3> grid(PETSC_COMM_WORLD, unit_elements, nullptr);
  const Part<3> part(grid, {three_blobs, true}, bottom);
  EXPECT_EQ(part.count(), 21);
  EXPECT_EQ(part.plate_contact(), 21);
  EXPECT_DOUBLE_EQ(part.volume(), 21.0);
  EXPECT_EQ(part.pieces().size(), 3u);
  EXPECT_EQ(part.pieces()[0].elements, 21);
  EXPECT_TRUE(part.pieces()[0].touches_plate);
  EXPECT_EQ(part.pieces()[1].elements, 4);
  EXPECT_EQ(part.pieces()[2].elements, 3);
  EXPECT_FALSE(part.pieces()[2].touches_plate);
  EXPECT_EQ(part.upper(), (Point<3>{7.0, 3.0, 1.0}));
  EXPECT_EQ(part.longest_edge(), 7.0);
  const std::vector<double> density = test::whole_element_field<3>(grid, part.density());
  EXPECT_EQ(std::accumulate(density.begin(), density.end(), 0.0), 21.0);
}

TEST(Part, ListsFivePiecesAtMost) {
  std::vector<Shape> blobs = {box({0, 0, 0}, {15, 1, 1})};
  for (int i = 0; i < 7; ++i) blobs.push_back(box({2.0 * i, 0, 2}, {2.0 * i + 1, 1, 3}));
  const std::string message = part_refusal<3>({{15, 1, 3}, {15, 1, 3}, 1.0}, union_of(blobs), bottom);
  EXPECT_NE(message.find("7 pieces are not"), std::string::npos) << message;
  EXPECT_NE(message.find("1 element in [8,0,2]..[9,1,3], and 2 more; set"), std::string::npos) << message;
}

TEST(Part, EdgesAndCornersDoNotConnect) {
  // Two columns of a checkerboard that share an edge; the second starts above the plate.
  const Shape edge = union_of({box({0, 0, 0}, {1, 1, 2}), box({1, 1, 1}, {2, 2, 2})});
  const std::string message = part_refusal<3>({{3, 3, 3}, {3, 3, 3}, 1.0}, edge, bottom);
  EXPECT_NE(message.find("1 piece is not connected to the build plate: 1 element in [1,1,1]..[2,2,2]; "
                         "set part.keep to \"connected\" to drop it"),
            std::string::npos)
      << message;
  const Shape plane = union_of({box({0, 0}, {1, 1}), box({1, 1}, {2, 2})});
  EXPECT_NE(part_refusal<2>({{3, 3}, {3, 3}, 1.0}, plane, {1, false}).find("1 piece is not"),
            std::string::npos);
}

TEST(Part, RefusesEmptyPartsAndMissingContact) {
  const std::string empty = part_refusal<3>(unit_elements, box({10, 10, 10}, {11, 11, 11}), bottom);
  EXPECT_EQ(empty.rfind("/part: no element has a density above 0", 0), 0u) << empty;
  const std::string above = part_refusal<3>(unit_elements, box({1, 1, 2}, {3, 2, 4}), bottom, true);
  EXPECT_EQ(above,
            "/build_plate: no element of the part has a face on the build plate z-; nearest: 4 elements in "
            "[1,1,2]..[3,2,4], needs contact with that face of the domain");
  const std::string flat = part_refusal<2>({{3, 3}, {3, 3}, 1.0}, box({0, 0}, {1, 1}), bottom);
  EXPECT_EQ(flat.rfind("/build_plate:", 0), 0u) << flat;
}

TEST(Part, StandsOnAnyFace) {
  const Domain<3> domain{{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0};
  const Grid<3> grid(PETSC_COMM_WORLD, domain, nullptr);
  const Part<3> part(grid, {box({0.4, 0.3, 0.5}, {1.4, 0.9, 1.5}), false}, {0, true});
  EXPECT_EQ(part.count(), 5 * 2 * 2);
  EXPECT_EQ(part.plate_contact(), 2 * 2);
  EXPECT_TRUE(part.on_plate({7, 0, 0}));
  EXPECT_FALSE(part.on_plate({0, 0, 0}));
  EXPECT_NEAR(part.volume(), 1.0 * 0.6 * 1.0, 1e-14);
  EXPECT_NEAR(part.longest_edge(), 1.0, 1e-14);
  EXPECT_NEAR(part.lower()[2], 0.5, 1e-14);
}

/// 1 or 0 by a hash of the element's number: about `fill` of all.
double speckle(std::int64_t number, double fill, int seed) {
  std::uint64_t x =
      static_cast<std::uint64_t>(number) + 0x9E3779B97F4A7C15ULL * static_cast<std::uint64_t>(seed + 1);
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<double>((x ^ (x >> 31)) % 1000) < 1000.0 * fill ? 1.0 : 0.0;
}

/// Lowest element of the piece of each element of the whole grid, -1 outside, by union-find.
template <int Dim>
std::vector<std::int64_t> serial_labels(const IndexBox<Dim>& all, const std::vector<double>& density) {
  std::vector<std::int64_t> parent(density.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int64_t e) {
    while (parent[e] != e) e = parent[e];
    return e;
  };
  all.for_each([&](const Index<Dim>& element, std::int64_t e) {
    for (int axis = 0; axis < Dim; ++axis) {
      Index<Dim> neighbor = element;
      ++neighbor[axis];
      if (!all.contains(neighbor) || density[e] == 0.0 || density[all.offset(neighbor)] == 0.0) continue;
      const std::int64_t a = root(e), b = root(all.offset(neighbor));
      parent[std::max(a, b)] = std::min(a, b);
    }
  });
  std::vector<std::int64_t> labels(density.size(), -1);
  for (std::size_t e = 0; e < density.size(); ++e)
    if (density[e] > 0.0) labels[e] = root(static_cast<std::int64_t>(e));
  return labels;
}

template <int Dim>
void compare_pieces(const Domain<Dim>& domain, const std::function<double(std::int64_t)>& density_of) {
  const Grid<Dim> grid(PETSC_COMM_WORLD, domain, nullptr);
  const IndexBox<Dim> all = grid.all_elements();
  std::vector<double> whole;
  for (std::int64_t e = 0; e < all.count(); ++e) whole.push_back(density_of(e));
  std::vector<double> density(static_cast<std::size_t>(grid.owned_elements().count()));
  grid.owned_elements().for_each(
      [&](const Index<Dim>& element, std::int64_t offset) { density[offset] = whole[all.offset(element)]; });

  const PieceMap<Dim> map = find_pieces<Dim>(grid, density, {Dim - 1, false});
  const std::vector<std::int64_t> labels = serial_labels<Dim>(all, whole);

  std::map<std::int64_t, std::int64_t> sizes;  // by label, ascending
  std::map<std::int64_t, bool> touches;
  all.for_each([&](const Index<Dim>& element, std::int64_t e) {
    if (labels[e] < 0) return;
    ++sizes[labels[e]];
    touches[labels[e]] |= element[Dim - 1] == 0;
  });
  std::vector<std::int64_t> order;
  for (const auto& [label, size] : sizes) order.push_back(label);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int64_t a, std::int64_t b) { return sizes[a] > sizes[b]; });

  EXPECT_EQ(map.pieces.size(), order.size());
  for (std::size_t i = 0; i < std::min(order.size(), map.pieces.size()); ++i) {
    EXPECT_EQ(map.pieces[i].elements, sizes[order[i]]);
    EXPECT_EQ(map.pieces[i].touches_plate, touches[order[i]]);
  }
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
    const std::int64_t label = labels[all.offset(element)];
    const int piece = map.piece_of_element[offset];
    EXPECT_EQ(label < 0, piece < 0);
    if (label >= 0 && piece >= 0) {
      EXPECT_EQ(order[piece], label);
      const Point<Dim> center = grid.element_center(element);
      for (int axis = 0; axis < Dim; ++axis) {
        EXPECT_LT(map.pieces[piece].min[axis], center[axis]);
        EXPECT_GT(map.pieces[piece].max[axis], center[axis]);
      }
    }
  });
}

TEST(FindPieces, AgreesWithASerialUnionFind) {
  // Near the percolation thresholds pieces wind through several ranks.
  for (int seed = 0; seed < 5; ++seed) {
    compare_pieces<2>({{1.7, 2.3}, {37, 41}, 1.0}, [&](std::int64_t e) { return speckle(e, 0.6, seed); });
    compare_pieces<3>({{1, 2, 3}, {13, 11, 17}, 1.0}, [&](std::int64_t e) { return speckle(e, 0.32, seed); });
  }
}

/// Elements and blocks of them that touch by edges and corners only.
TEST(FindPieces, DoNotJoinAtCorners) {
  for (const int edge : {1, 3}) {
    const auto is_even = [edge](const auto& element) {
      int blocks = 0;
      for (const int i : element) blocks += i / edge;
      return blocks % 2 == 0 ? 1.0 : 0.0;
    };
    const IndexBox<2> plane{{}, {14, 19}};
    compare_pieces<2>({{1.4, 1.9}, plane.size, 1.0}, [&](std::int64_t e) { return is_even(plane.index(e)); });
    const IndexBox<3> box{{}, {8, 9, 10}};
    compare_pieces<3>({{1, 2, 3}, box.size, 1.0}, [&](std::int64_t e) { return is_even(box.index(e)); });
  }
}

/// Two arms that wind around each other from the edge to the middle, in 3D as walls: each crosses the
/// boundaries between the ranks in every turn.
TEST(FindPieces, FollowsTwoSpiralsThatWindAroundEachOther) {
  // Along a ray of any direction the arms and the gaps between them take turns.
  const auto is_arm = [](int x, int y, int extent) {
    const double u = x + 0.5 - 0.5 * extent, v = y + 0.5 - 0.5 * extent;
    const double turns = std::hypot(u, v) / 12.0 - std::atan2(v, u) / (2.0 * std::acos(-1.0));
    return std::fmod(2.0 * (turns + 8.0), 1.0) < 0.6 ? 1.0 : 0.0;
  };
  const IndexBox<2> plane{{}, {73, 73}};
  compare_pieces<2>({{1.0, 1.0}, plane.size, 1.0},
                    [&](std::int64_t e) { return is_arm(plane.index(e)[0], plane.index(e)[1], 73); });
  const IndexBox<3> box{{}, {41, 5, 41}};
  compare_pieces<3>({{1, 0.2, 1}, box.size, 1.0},
                    [&](std::int64_t e) { return is_arm(box.index(e)[0], box.index(e)[2], 41); });
}

TEST(FindPieces, FollowsASpiralThroughAllRanks) {
  // A comb: one piece that goes up and down through every rank many times.
  const Grid<2> grid(PETSC_COMM_WORLD, {{1, 1}, {41, 40}, 1.0}, nullptr);
  std::vector<double> density(static_cast<std::size_t>(grid.owned_elements().count()));
  grid.owned_elements().for_each([&](const Index<2>& e, std::int64_t offset) {
    const bool bridge = e[1] == (e[0] % 4 == 1 ? 39 : 0);
    density[offset] = e[0] % 2 == 0 || bridge ? 1.0 : 0.0;
  });
  const PieceMap<2> map = find_pieces<2>(grid, density, {1, false});
  EXPECT_EQ(map.pieces.size(), 1u);
  EXPECT_EQ(map.pieces.at(0).elements, 21 * 40 + 20);
}

TEST(Part, ListsElementsAndTouchedNodes) {
  const Domain<3> domain{{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0};
  const Shape l_shape = union_of({box({0, 0, 0}, {1.4, 0.9, 0.5}), box({1.0, 0, 0}, {1.4, 0.6, 2.5})});
  const Grid<3> grid(PETSC_COMM_WORLD, domain, nullptr);
  const Part<3> part(grid, {l_shape, false}, bottom);
  EXPECT_EQ(part.count(), 7 * 3 + 2 * 2 * 4);
  EXPECT_TRUE(std::is_sorted(part.elements().begin(), part.elements().end()));
  const auto inside = [](const Index<3>& e) { return e[2] == 0 || (e[0] >= 5 && e[1] < 2); };
  grid.owned_elements().for_each([&](const Index<3>& element, std::int64_t offset) {
    const bool listed =
        std::binary_search(part.elements().begin(), part.elements().end(), static_cast<int>(offset));
    EXPECT_EQ(listed, inside(element));
    EXPECT_EQ(part.density()[offset], inside(element) ? 1.0 : 0.0);
  });
  for (std::size_t i = 0; i < part.elements().size(); ++i)
    EXPECT_EQ(part.first_corners()[i], grid.first_corner(grid.owned_elements().index(part.elements()[i])));
  grid.owned_nodes().for_each([&](const Index<3>& node, std::int64_t offset) {
    bool touched = false;
    for (int corner = 0; corner < 8; ++corner) {
      const Index<3> element{node[0] - (corner & 1), node[1] - ((corner >> 1) & 1),
                             node[2] - ((corner >> 2) & 1)};
      touched |= grid.all_elements().contains(element) && inside(element);
    }
    EXPECT_EQ(part.touched_nodes()[offset] != 0, touched);
  });

  std::vector<double> numbers(part.elements().begin(), part.elements().end());
  const std::vector<double> field = part.expand(numbers, -1.0);
  EXPECT_EQ(part.restrict_to_part(field), numbers);
  EXPECT_EQ(std::count(field.begin(), field.end(), -1.0),
            grid.owned_elements().count() - static_cast<std::int64_t>(numbers.size()));
}

TEST(MakeBalancedGrid, EvensOutWeightedElements) {
  // An L that fills 44 % of the box; equal ranges along x or z would leave one rank with most of it.
  const Domain<3> domain{{2, 1, 2}, {20, 12, 20}, 1.0};
  const PartDescription description{union_of({box({0, 0, 0}, {2, 1, 0.6}), box({1.6, 0, 0}, {2, 1, 2})}),
                                    false};
  const Grid<3> grid = make_balanced_grid<3>(PETSC_COMM_WORLD, domain, description);
  const Part<3> part(grid, description, bottom);
  EXPECT_EQ(part.count(), 20 * 12 * 6 + 4 * 12 * 14);
  const double inside = static_cast<double>(part.elements().size());
  const double own = inside + 0.1 * (static_cast<double>(grid.owned_elements().count()) - inside);
  EXPECT_LE(max(PETSC_COMM_WORLD, own), 1.01 * sum(PETSC_COMM_WORLD, own) / size_of(PETSC_COMM_WORLD));
}

}  // namespace
}  // namespace fabseq
