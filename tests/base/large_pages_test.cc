// SPDX-License-Identifier: MIT
/// Memory on large pages.
#include "fabseq/base/large_pages.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <new>

namespace fabseq {
namespace {

TEST(LargePagesTest, GivesZeroedMemoryAlignedToAPage) {
  for (const std::size_t bytes : {std::size_t{1}, large_page, large_page + 1, 3 * large_page}) {
    auto* const place = static_cast<char*>(map_large_pages(bytes));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(place) % large_page, 0U);
    EXPECT_EQ(place[0], 0);
    EXPECT_EQ(place[bytes - 1], 0);
    std::memset(place, 1, bytes);
    unmap_large_pages(place);
  }
}

TEST(LargePagesTest, KeepsPiecesWhileAskedTo) {
  void* const small = map_large_pages(large_page);
  void* const large = map_large_pages(3 * large_page);
  {
    const KeptLargePages kept;
    unmap_large_pages(small);
    unmap_large_pages(large);
  }
  EXPECT_EQ(map_large_pages(2 * large_page), large);  // the smallest that is large enough
  EXPECT_EQ(map_large_pages(1), small);
  unmap_large_pages(small);
  auto* const place = static_cast<char*>(map_large_pages(4 * large_page));  // none is kept any more
  EXPECT_EQ(place[4 * large_page - 1], 0);
  unmap_large_pages(place);
  unmap_large_pages(large);
}

TEST(LargePagesTest, WhatIsTooSmallGoesBackToTheSystem) {
  auto* const small = static_cast<char*>(map_large_pages(large_page));
  small[0] = 1;
  {
    const KeptLargePages kept;
    unmap_large_pages(small);
  }
  void* const larger = map_large_pages(2 * large_page);
  auto* const place = static_cast<char*>(map_large_pages(large_page));
  EXPECT_EQ(place[0], 0);
  unmap_large_pages(place);
  unmap_large_pages(larger);
  KeptLargePages::drop();
}

TEST(LargePagesTest, RefusesWhatNoMachineHas) {
  EXPECT_THROW(map_large_pages(std::numeric_limits<std::size_t>::max() / 4), std::bad_alloc);
}

}  // namespace
}  // namespace fabseq
