// SPDX-License-Identifier: MIT
/// Sums over the holders of a node against sums over all ranks.
#include "ranks/shared_nodes.h"
#include "support/masked_grid.h"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

namespace fabseq {
namespace {

/// A compact grid, where four ranks meet, and a long one, where the ranks stand in a row.
template <int Dim>
std::vector<Index<Dim>> sizes() {
  if constexpr (Dim == 2)
    return {{9, 8}, {19, 2}};
  else
    return {{7, 6, 3}, {2, 2, 17}};
}

template <int Dim>
struct Shares {
  Shares(const Index<Dim>& elements, const test::Mask<Dim>& mask)
      : masked(PETSC_COMM_WORLD, elements, mask, {Dim - 1, false}),
        all(masked.grid.all_nodes()),
        mesh(mesh_of(masked)),
        shared(PETSC_COMM_WORLD, mesh),
        holders(all.count(), 0) {
    for_each([&](std::int64_t, std::int64_t at) { ++holders[at]; });
    sum_in_place(PETSC_COMM_WORLD, holders);
  }
  static LaneMesh<Dim> mesh_of(const test::MaskedGrid<Dim>& masked) {
    std::vector<char> active;
    masked.grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t) {
      active.push_back(masked.whole.active[masked.whole.elements.offset(element)]);
    });
    return LaneMesh<Dim>(masked.grid.owned_elements(), active);
  }
  /// f(number in the mesh, number in the grid) of this rank's nodes.
  template <class Function>
  void for_each(Function&& f) const {
    test::for_each_node(mesh,
                        [&](const Index<Dim>& node, std::int64_t number) { f(number, all.offset(node)); });
  }
  /// Number in the grid of each shared node.
  std::vector<std::int64_t> places() const {
    std::vector<std::int64_t> of_number(mesh.nodes()), result;
    for_each([&](std::int64_t number, std::int64_t at) { of_number[number] = at; });
    for (const std::int64_t node : shared.nodes()) result.push_back(of_number[node]);
    return result;
  }

  test::MaskedGrid<Dim> masked;
  IndexBox<Dim> all;
  LaneMesh<Dim> mesh;
  SharedNodes shared;
  std::vector<std::int64_t> holders;  ///< ranks that have each node of the grid
};

template <int Dim, class Function>
void for_each_case(Function&& f) {
  for (const auto& size : sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      SCOPED_TRACE(mask.name + " " + to_text<Dim>(size));
      Shares<Dim> shares(size, mask);
      f(shares);
    }
}

template <class T>
class SharedNodesTest : public testing::Test {};
TYPED_TEST_SUITE(SharedNodesTest, test::Dimensions);

TYPED_TEST(SharedNodesTest, AreThoseThatSeveralRanksHold) {
  for_each_case<TypeParam::value>([](const auto& shares) {
    std::vector<std::int64_t> expected;
    shares.for_each([&](std::int64_t number, std::int64_t at) {
      if (shares.holders[at] > 1) expected.push_back(number);
    });
    EXPECT_EQ(shares.shared.nodes(), expected);
  });
}

TYPED_TEST(SharedNodesTest, OneHolderCounts) {
  for_each_case<TypeParam::value>([](const auto& shares) {
    std::vector<std::int64_t> counting(shares.all.count(), 0);
    const auto places = shares.places();
    ASSERT_EQ(shares.shared.counted().size(), places.size());
    for (std::size_t i = 0; i < places.size(); ++i) counting[places[i]] += shares.shared.counted()[i];
    sum_in_place(PETSC_COMM_WORLD, counting);
    for (std::size_t at = 0; at < counting.size(); ++at)
      EXPECT_EQ(counting[at], shares.holders[at] > 1 ? 1 : 0);
  });
}

TYPED_TEST(SharedNodesTest, SumsOverAllHolders) {
  const int rank = rank_of(PETSC_COMM_WORLD);
  for_each_case<TypeParam::value>([&](auto& shares) {
    const auto places = shares.places();
    for (const int block : {1, 3, 24}) {
      const auto value = [&](std::int64_t at, int entry, int of_rank) {
        return (test::noise(at * block + entry, of_rank) - 0.5) * std::pow(10.0, 3.0 * of_rank);
      };
      std::vector<double> expected(shares.all.count() * block, 0.0), values;
      shares.for_each([&](std::int64_t, std::int64_t at) {
        for (int entry = 0; entry < block; ++entry) expected[at * block + entry] = value(at, entry, rank);
      });
      sum_in_place(PETSC_COMM_WORLD, expected);
      for (const std::int64_t at : places)
        for (int entry = 0; entry < block; ++entry) values.push_back(value(at, entry, rank));
      std::vector<float> rounded(values.begin(), values.end());
      shares.shared.sum(std::span(values), block);
      shares.shared.sum(std::span(rounded), block);
      for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(rounded[i], values[i], 1e-6 * std::pow(10.0, 3.0 * size_of(PETSC_COMM_WORLD)));
      // The bits of all holders, as numbers, add up to a multiple of this rank's (modulo 2^64).
      std::vector<std::int64_t> bits(expected.size(), 0);
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t at = places[i / block] * block + i % block;
        EXPECT_NEAR(values[i], expected[at], 1e-15 * std::pow(10.0, 3.0 * size_of(PETSC_COMM_WORLD)));
        bits[at] = std::bit_cast<std::int64_t>(values[i]);
      }
      const auto own = bits;
      sum_in_place(PETSC_COMM_WORLD, bits);
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t at = places[i / block] * block + i % block;
        EXPECT_EQ(
            static_cast<std::uint64_t>(bits[at]),
            static_cast<std::uint64_t>(own[at]) * static_cast<std::uint64_t>(shares.holders[at / block]))
            << "holders differ in a bit";
      }
    }
  });
}

/// Elements on one side of every interface only: nobody else holds its nodes.
TYPED_TEST(SharedNodesTest, NodesOfOneSideAreNotShared) {
  constexpr int Dim = TypeParam::value;
  const auto size = sizes<Dim>()[0];
  const test::MaskedGrid<Dim> whole(PETSC_COMM_WORLD, size, test::masks<Dim>()[0], {Dim - 1, false});
  // Rank 0 has its elements, the others none: no interface has elements on both sides.
  std::vector<std::int64_t> first(whole.grid.all_elements().count(), 0);
  whole.grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t) {
    first[whole.grid.all_elements().offset(element)] = rank_of(PETSC_COMM_WORLD) == 0 ? 1 : 0;
  });
  sum_in_place(PETSC_COMM_WORLD, first);
  Shares<Dim> shares(size, {"rank 0", [&](const Index<Dim>& element) {
                              return first[whole.grid.all_elements().offset(element)] != 0;
                            }});
  EXPECT_EQ(shares.mesh.elements() > 0, rank_of(PETSC_COMM_WORLD) == 0);
  EXPECT_TRUE(shares.shared.nodes().empty());
  std::vector<double> nothing;
  shares.shared.sum(std::span(nothing), 3);
}

}  // namespace
}  // namespace fabseq
