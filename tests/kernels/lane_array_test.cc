// SPDX-License-Identifier: MIT
/// Arrays of the lane solver, small ones and those on large pages.
#include "kernels/lane_array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace fabseq {
namespace {

TEST(LaneArrayTest, GrowsAndShrinks) {
  LaneValues<float> values{1.0F, 2.0F};
  const std::size_t large = 3 * large_page / sizeof(float);
  values.resize(large, 3.0F);
  EXPECT_EQ(values[1], 2.0F);
  EXPECT_EQ(values[large - 1], 3.0F);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values.data()) % large_page, 0U);
  values.resize(2);
  values.shrink_to_fit();
  EXPECT_EQ(values[1], 2.0F);
  free_memory(values);
  EXPECT_EQ(values.capacity(), 0U);
}

}  // namespace
}  // namespace fabseq
