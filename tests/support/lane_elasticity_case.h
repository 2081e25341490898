// SPDX-License-Identifier: MIT
/// \file
/// Layers of a V-shape, and their displacements as they must be.
#pragma once

#include "support/layered_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq::test {

/// Share of the largest displacement of a lane that an error may have, at a tolerance of 1e-9.
inline constexpr double close = 1e-6;

template <int Dim>
Index<Dim> v_elements() {
  if constexpr (Dim == 2)
    return {41, 37};
  else
    return {17, 7, 16};
}
template <int Dim>
LayeredSettings<Dim> v_settings() {
  LayeredSettings<Dim> settings{v_domain<Dim>(v_elements<Dim>()), v_shape<Dim>()};
  settings.layers = Dim == 2 ? 5 : 2;
  return settings;
}
/// Displacements of v_settings(), for the tests that need no others.
template <int Dim>
const std::vector<std::vector<double>>& v_displacements() {
  static const auto result = LayeredCase<Dim>::exact(v_settings<Dim>());
  return result;
}

template <int Dim>
void expect_solved(const LayeredCase<Dim>& layered, const LaneVector& displacement,
                   const std::vector<SolveReport>& reports, const std::vector<std::vector<double>>& expected,
                   const std::vector<int>& left_out = {}, double limit = close) {
  ASSERT_EQ(reports.size(), expected.size());
  for (int lane = 0; lane < static_cast<int>(expected.size()); ++lane) {
    if (std::find(left_out.begin(), left_out.end(), lane) != left_out.end()) continue;
    EXPECT_TRUE(reports[lane].converged) << lane;
    EXPECT_LE(reports[lane].residual, 1e-9) << lane;
    EXPECT_LT(relative_difference(layered.whole(displacement, lane), expected[lane]), limit) << lane;
  }
}

}  // namespace fabseq::test

namespace fabseq {

template <class T>
class LaneElasticityTest : public testing::Test {};
TYPED_TEST_SUITE(LaneElasticityTest, test::Dimensions);

}  // namespace fabseq
