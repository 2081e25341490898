// SPDX-License-Identifier: MIT
/// Lane arithmetic is plain arithmetic in every lane, whatever the width and the alignment.
#include "kernels/lanes.h"

#include "support/masked_box.h"

#include <gtest/gtest.h>

#include <array>

namespace fabseq {
namespace {

#if defined(FABSEQ_PORTABLE) && defined(__x86_64__)
static_assert(native_lanes == 2, "compiled for this processor after all");
#endif

using test::for_each_width;

template <int Width>
std::array<double, Width> numbers(int salt) {
  std::array<double, Width> result;
  for (int lane = 0; lane < Width; ++lane) result[lane] = test::noise(lane, salt) - 0.4;
  return result;
}

TEST(LanesTest, LoadsAndStoresAtAnyPlace) {
  for_each_width([]<int Width>() {
    std::array<double, 24> from, to;
    for (int shift = 0; shift < 8; ++shift) {
      for (int i = 0; i < 24; ++i) from[i] = 0.1 + i;
      to.fill(-1.0);
      Lanes<Width>::load(&from[shift]).store(&to[shift]);
      for (int i = 0; i < 24; ++i)
        EXPECT_EQ(to[i], i < shift || i >= shift + Width ? -1.0 : from[i]) << Width << " " << shift;
    }
  });
}

TEST(LanesTest, StreamsToAlignedPlaces) {
  for_each_width([]<int Width>() {
    alignas(64) std::array<double, 24> to;
    to.fill(-1.0);
    const auto from = numbers<Width>(1);
    Lanes<Width>::load(from.data()).stream(&to[8]);
    for (int i = 0; i < 24; ++i) EXPECT_EQ(to[i], i < 8 || i >= 8 + Width ? -1.0 : from[i - 8]) << Width;
  });
}

TEST(LanesTest, WidensSinglePrecision) {
  for_each_width([]<int Width>() {
    std::array<float, 16> from;
    for (int i = 0; i < 16; ++i) from[i] = 1.0F / static_cast<float>(3 * i + 1);
    for (int shift = 0; shift < 8; ++shift) {
      const auto lanes = Lanes<Width>::load(&from[shift]);
      for (int lane = 0; lane < Width; ++lane)
        EXPECT_EQ(lanes[lane], static_cast<double>(from[shift + lane]));
    }
  });
}

TEST(LanesTest, RoundsToSinglePrecision) {
  for_each_width([]<int Width>() {
    const auto from = numbers<Width>(1);
    std::array<float, 24> to;
    for (int shift = 0; shift < 8; ++shift) {
      to.fill(-1.0F);
      Lanes<Width>::load(from.data()).store(&to[shift]);
      const auto rounded = Lanes<Width, float>::load(from.data());
      const auto wide = widened(rounded);
      for (int i = 0; i < 24; ++i)
        EXPECT_EQ(to[i], i < shift || i >= shift + Width ? -1.0F : static_cast<float>(from[i - shift]));
      for (int lane = 0; lane < Width; ++lane) {
        EXPECT_EQ(rounded[lane], static_cast<float>(from[lane]));
        EXPECT_EQ(wide[lane], static_cast<double>(static_cast<float>(from[lane])));
      }
    }
  });
}

TEST(LanesTest, CalculatesInSinglePrecision) {
  for_each_width([]<int Width>() {
    const auto x = numbers<Width>(1), y = numbers<Width>(2);
    const auto a = Lanes<Width, float>::load(x.data()), b = Lanes<Width, float>::load(y.data());
    const auto result = (a - b) * a + b / a * 0.5F;
    alignas(64) std::array<float, 16> streamed;
    result.stream(streamed.data());
    for (int lane = 0; lane < Width; ++lane) {
      EXPECT_NEAR(result[lane], (x[lane] - y[lane]) * x[lane] + y[lane] / x[lane] * 0.5,
                  1e-6 * (1.0 + std::abs(y[lane] / x[lane])));
      EXPECT_EQ(streamed[lane], result[lane]);
    }
  });
}

/// 0, 1, 2, … from `first` on.
template <int Width>
Lanes<Width> counted(int first) {
  std::array<double, Width> values;
  for (int lane = 0; lane < Width; ++lane) values[lane] = first + lane;
  return Lanes<Width>::load(values.data());
}

TEST(LanesTest, JoinsPieces) {
  const auto pair = joined(counted<1>(5), counted<1>(6));
  EXPECT_EQ(pair[0], 5);
  EXPECT_EQ(pair[1], 6);
  const auto all = joined_pieces<native_lanes>([](int k) { return counted<1>(k); });
  for (int lane = 0; lane < native_lanes; ++lane) EXPECT_EQ(all[lane], lane);
  const auto wide = joined_pieces<native_lanes / 2>([](int k) { return counted<2>(2 * k); });
  for (int lane = 0; lane < native_lanes; ++lane) EXPECT_EQ(wide[lane], lane);
}

TEST(LanesTest, RowsBecomeColumns) {
  for_each_width([]<int Width>() {
    if constexpr (Width > 1) {
      std::array<Lanes<Width>, Width> rows;
      for (int row = 0; row < Width; ++row) rows[row] = counted<Width>(100 * row);
      const auto columns = transposed<Width>(rows);
      for (int row = 0; row < Width; ++row)
        for (int lane = 0; lane < Width; ++lane) EXPECT_EQ(columns[row][lane], 100 * lane + row) << Width;
    }
  });
}

TEST(LanesTest, TakesPiecesOutOfRegisters) {
  const auto before = counted<native_lanes>(0), behind = counted<native_lanes>(native_lanes);
  const auto next = lanes_from<native_lanes, 1>(before, behind);
  const auto previous = lanes_from<native_lanes, native_lanes - 1>(before, behind);
  for (int lane = 0; lane < native_lanes; ++lane) {
    EXPECT_EQ(next[lane], lane + 1);
    EXPECT_EQ(previous[lane], lane + native_lanes - 1);
  }
  const auto last = lanes_from<1, native_lanes - 1>(before, behind);
  EXPECT_EQ(last[0], native_lanes - 1);
  const auto upper = lanes_from<native_lanes / 2, native_lanes / 2>(before, behind);
  for (int lane = 0; lane < native_lanes / 2; ++lane) EXPECT_EQ(upper[lane], native_lanes / 2 + lane);
}

TEST(LanesTest, TakesPairsApart) {
  std::array<float, 16> pairs;
  for (int i = 0; i < 16; ++i) pairs[i] = 0.5F + static_cast<float>(i);
  for_each_width([&]<int Width>() {
    if constexpr (Width <= register_bytes / static_cast<int>(sizeof(float)))
      for (int which = 0; which < 2; ++which) {
        const auto found = of_pairs<Width>(pairs.data(), which);
        for (int pair = 0; pair < Width; ++pair) EXPECT_EQ(found[pair], pairs[2 * pair + which]);
      }
  });
}

TEST(LanesTest, AddsUpNodesSideBySide) {
  const auto values = numbers<8>(3);
  const auto nodes = Lanes<8>::load(values.data());
  Lanes<8> all = Lanes<8>::broadcast(1.0);
  Lanes<2> pairs = Lanes<2>::broadcast(1.0);
  Lanes<1> one = Lanes<1>::broadcast(1.0);
  add_up(nodes, all);
  add_up(nodes, pairs);
  add_up(nodes, one);
  for (int lane = 0; lane < 8; ++lane) EXPECT_EQ(all[lane], 1.0 + values[lane]);
  for (int lane = 0; lane < 2; ++lane)
    EXPECT_EQ(pairs[lane], 1.0 + values[lane] + values[lane + 2] + values[lane + 4] + values[lane + 6]);
  double sum = 1.0;
  for (const double value : values) sum += value;
  EXPECT_EQ(one[0], sum);
}

TEST(LanesTest, AddsUpSinglePrecisionInDouble) {
  const std::array<float, 8> values{1.0F, 1e-9F, 1e-9F, 1e-9F, 1e-9F, 1e-9F, 1e-9F, 1e-9F};
  Lanes<1> sum = Lanes<1>::zero();
  add_up(Lanes<8, float>::load(values.data()), sum);
  EXPECT_NEAR(sum[0], 1.0 + 7e-9, 1e-15);
}

TEST(LanesTest, Broadcasts) {
  for_each_width([]<int Width>() {
    const auto lanes = Lanes<Width>::broadcast(0.3);
    const auto zero = Lanes<Width>::zero();
    for (int lane = 0; lane < Width; ++lane) {
      EXPECT_EQ(lanes[lane], 0.3);
      EXPECT_EQ(zero[lane], 0.0);
    }
  });
}

TEST(LanesTest, CalculatesLaneByLane) {
  for_each_width([]<int Width>() {
    const auto x = numbers<Width>(1), y = numbers<Width>(2);
    const auto a = Lanes<Width>::load(x.data()), b = Lanes<Width>::load(y.data());
    auto added = a;
    added += b;
    const auto sum = a + b, difference = a - b, product = a * b, scaled = a * 0.7, quotient = a / b;
    for (int lane = 0; lane < Width; ++lane) {
      EXPECT_EQ(a[lane], x[lane]);
      EXPECT_EQ(added[lane], x[lane] + y[lane]);
      EXPECT_EQ(sum[lane], x[lane] + y[lane]);
      EXPECT_EQ(difference[lane], x[lane] - y[lane]);
      EXPECT_EQ(product[lane], x[lane] * y[lane]);
      EXPECT_EQ(scaled[lane], x[lane] * 0.7);
      EXPECT_EQ(quotient[lane], x[lane] / y[lane]);
    }
  });
}

TEST(LanesTest, WhatIsNoNumberStaysInItsLane) {
  for_each_width([]<int Width>() {
    auto x = numbers<Width>(1);
    x[Width / 2] = NAN;
    const auto a = Lanes<Width>::load(x.data());
    const auto b = (a * a + a) / a - a * 2.0;
    for (int lane = 0; lane < Width; ++lane) EXPECT_EQ(std::isnan(b[lane]), lane == Width / 2);
  });
}

}  // namespace
}  // namespace fabseq
