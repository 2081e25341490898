// SPDX-License-Identifier: MIT
/// Reductions and lists over ranks, in messages that MPI can count.
#include "fabseq/base/mpi.h"

#include "fabseq/base/mpi_struct.h"
#include "fabseq/base/petsc.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

/// No entry is left out or comes twice, and nobody waits for a message that others do not send.
TEST(Mpi, MessagesCoverAnArray) {
  for (const std::size_t size : {0U, 1U, 6U, 7U, 8U, 14U, 15U}) {
    std::vector<int> values(size, 0);
    int messages = 0;
    for_each_message(
        std::span(values),
        [&](std::span<int> part) {
          EXPECT_LE(part.size(), 7U);
          for (int& value : part) ++value;
          ++messages;
        },
        7);
    EXPECT_EQ(values, std::vector<int>(size, 1));
    EXPECT_EQ(messages, size == 0 ? 1 : static_cast<int>((size + 6) / 7));
  }
}

TEST(Mpi, ListsGoFromEveryRankToEveryRank) {
  struct Item {
    int from = 0;
    char letter = 'a';
    double value = 0.0;
  };
  const int ranks = size_of(PETSC_COMM_WORLD), rank = rank_of(PETSC_COMM_WORLD);
  std::vector<std::vector<Item>> outgoing(static_cast<std::size_t>(ranks));
  for (int to = 0; to < ranks; ++to)  // as many as both numbers together: none from 0 to 0
    for (int i = 0; i < rank + to; ++i) outgoing[to].push_back({rank, 'b', i + 0.5});
  const auto incoming = exchange_lists(PETSC_COMM_WORLD, outgoing);
  ASSERT_EQ(incoming.size(), outgoing.size());
  for (int from = 0; from < ranks; ++from) {
    ASSERT_EQ(incoming[from].size(), static_cast<std::size_t>(rank + from));
    for (int i = 0; i < rank + from; ++i) {
      EXPECT_EQ(incoming[from][i].from, from);
      EXPECT_EQ(incoming[from][i].letter, 'b');
      EXPECT_EQ(incoming[from][i].value, i + 0.5);
    }
  }
}

TEST(Mpi, GathersListsOfAnyLength) {
  const int ranks = size_of(PETSC_COMM_WORLD), rank = rank_of(PETSC_COMM_WORLD);
  const std::vector<std::int64_t> own(static_cast<std::size_t>(rank), rank);
  std::vector<std::int64_t> expected;
  for (int from = 0; from < ranks; ++from) expected.insert(expected.end(), from, from);
  EXPECT_EQ(gather_all(PETSC_COMM_WORLD, own), expected);
}

}  // namespace
}  // namespace fabseq
