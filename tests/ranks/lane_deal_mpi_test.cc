// SPDX-License-Identifier: MIT
/// Lanes that are taken to the ranks that solve them, and back.
#include "fabseq/base/mpi.h"
#include "ranks/lane_deal.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <numeric>
#include <vector>

namespace fabseq {
namespace {

constexpr int node_count = 10, components = 2, width = 4;

/// Rank r has nodes 2 r to 2 r + 4, and every third has none; rows run backwards.
struct Case {
  Case() {
    for (int node = 2 * (rank % 3); rank % 3 != 2 && node < 2 * (rank % 3) + 5; ++node)
      numbers.push_back(node);
    rows.resize(node_count * components);
    std::iota(rows.rbegin(), rows.rend(), 0);
    deal = LaneDeal(PETSC_COMM_WORLD, numbers);
  }
  double part(std::int64_t node, int component, int lane, int of_rank) const {
    return static_cast<double>(node * 100 + component * 10 + lane) + 0.25 * of_rank;
  }

  int rank = rank_of(PETSC_COMM_WORLD);
  std::vector<std::int64_t> numbers;
  std::vector<int> rows;
  LaneDeal deal;
};

std::vector<std::vector<int>> dealings() {
  const int ranks = size_of(PETSC_COMM_WORLD);
  return {{0, 1 % ranks, 2 % ranks, 3 % ranks}, {0, 0, 0, 0}, {ranks - 1, 0, ranks - 1, 0}};
}

TEST(LaneDeal, OwnersGetTheSumOfAllParts) {
  Case c;
  for (const bool side_by_side : {false, true})
    for (const auto& owners : dealings()) {
      const std::size_t size = c.rows.size();
      const LaneDeal::Layout layout = side_by_side ? LaneDeal::Layout{c.rows, components, width, 1}
                                                   : LaneDeal::Layout{c.rows, components, 1, size};
      std::vector<double> expected(size * width, 0.0), sums(size * width, 0.0);
      std::vector<float> parts;
      const auto place = [&](std::int64_t node, int a, int lane) {
        return c.rows[node * components + a] * layout.row_stride + lane * layout.lane_stride;
      };
      for (const std::int64_t node : c.numbers)
        for (int a = 0; a < components; ++a)
          for (int lane = 0; lane < width; ++lane) {
            parts.push_back(static_cast<float>(c.part(node, a, lane, c.rank)));
            expected[place(node, a, lane)] += c.part(node, a, lane, c.rank);
          }
      sum_in_place(PETSC_COMM_WORLD, expected);
      c.deal.add_at_owners<float>(owners, layout, parts.data(), sums.data());
      for (int node = 0; node < node_count; ++node)
        for (int a = 0; a < components; ++a)
          for (int lane = 0; lane < width; ++lane)
            EXPECT_EQ(sums[place(node, a, lane)],
                      owners[lane] == c.rank ? expected[place(node, a, lane)] : 0.0);
    }
}

TEST(LaneDeal, EachGetsItsNodesOfAllLanes) {
  Case c;
  for (const auto& owners : dealings()) {
    const LaneDeal::Layout layout{c.rows, components, 1, c.rows.size()};
    std::vector<double> found(c.rows.size() * width, -1.0);
    for (int node = 0; node < node_count; ++node)
      for (int a = 0; a < components; ++a)
        for (int lane = 0; lane < width; ++lane)
          if (owners[lane] == c.rank)
            found[c.rows[node * components + a] + lane * layout.lane_stride] = c.part(node, a, lane, 0);
    std::vector<double> parts(c.numbers.size() * components * width, -2.0);
    c.deal.fetch_from_owners<double>(owners, layout, found.data(), parts.data());
    std::size_t next = 0;
    for (const std::int64_t node : c.numbers)
      for (int a = 0; a < components; ++a)
        for (int lane = 0; lane < width; ++lane) EXPECT_EQ(parts[next++], c.part(node, a, lane, 0));
  }
}

}  // namespace
}  // namespace fabseq
