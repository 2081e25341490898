// SPDX-License-Identifier: MIT
/// Memory that there is and that is asked for.
#include "fabseq/base/memory.h"
#include "support/refusal.h"

#include <gtest/gtest.h>
#include <petscsys.h>

namespace fabseq {
namespace {

TEST(MemoryTest, ThereIsMoreThanWasUsed) {
  const std::int64_t used = peak_memory_bytes(PETSC_COMM_WORLD);
  EXPECT_GT(used, 1000000);
  EXPECT_GT(installed_memory_bytes(PETSC_COMM_WORLD), used);
  EXPECT_LT(installed_memory_bytes(PETSC_COMM_WORLD), std::int64_t{1} << 60);
}

TEST(MemoryTest, MoreThanThereIsIsRefused) {
  EXPECT_NO_THROW(require_memory(PETSC_COMM_WORLD, 1e6, "/key: 3 things"));
  const std::string text = test::refusal([] { require_memory(PETSC_COMM_WORLD, 1e24, "/key: 3 things"); });
  EXPECT_EQ(text.rfind("/key: 3 things need at least 1e+15 GB of memory; allowed: at most the ", 0), 0u)
      << text;
}

}  // namespace
}  // namespace fabseq
