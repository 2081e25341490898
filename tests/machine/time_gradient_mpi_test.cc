// SPDX-License-Identifier: MIT
/// The gradient that checks go by (docs/formulation.md 13.1), on 1 to 4 ranks.
#include "fabseq/machine/time_gradient.h"
#include "fabseq/sequence/given_sequence.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

using test::box;
using test::PartOnGrid;

LayerDensities layers_of(int count) {
  LayerDensities result;
  result.layer.resize(count);
  return result;
}

/// A time at the centre of each part element.
template <int Dim, class Function>
PseudoTime<Dim> time_of(const Part<Dim>& part, Function&& function) {
  PseudoTime<Dim> result;
  for (const int element : part.elements())
    result.time.push_back(function(part.grid().element_center(part.grid().owned_elements().index(element))));
  return result;
}

TEST(TimeGradientTest, OfASequenceThatHasOneIsItsOwn) {
  const PartOnGrid<2> on_grid(test::odd_domain<2>(), test::block<2>());
  PseudoTime<2> time = planar_time(on_grid.part, {1.0, 2.0});
  const TimeGradient own = time_gradient(on_grid.part, time, layers_of(3));
  EXPECT_EQ(own.values, time.gradient);
  EXPECT_EQ(own.source, GradientSource::sequence);
  time.recorded_gradient = std::move(time.gradient);
  time.gradient.clear();
  const TimeGradient recorded = time_gradient(on_grid.part, time, layers_of(3));
  EXPECT_EQ(recorded.values, time.recorded_gradient);
  EXPECT_EQ(recorded.source, GradientSource::file);
}

TEST(TimeGradientTest, DifferencesOfALinearTimeAreExactAlsoAtTheSurface) {
  const Domain<3> domain{{3.0, 2.0, 2.4}, {6, 5, 8}, 1.0};
  const PartOnGrid<3> on_grid(domain,
                              test::union_of({box({0, 0, 0}, {3, 2, 0.6}), box({0, 0, 0}, {1, 2, 2.4})}));
  const auto time =
      time_of<3>(on_grid.part, [](const Point<3>& x) { return 0.1 + 0.2 * x[0] - 0.05 * x[1] + 0.1 * x[2]; });
  const TimeGradient found = time_gradient(on_grid.part, time, layers_of(4));
  EXPECT_EQ(found.source, GradientSource::differences);
  const double expected[] = {0.2, -0.05, 0.1};
  ASSERT_EQ(found.values.size(), 3 * time.time.size());
  for (std::size_t i = 0; i < found.values.size(); ++i) EXPECT_NEAR(found.values[i], expected[i % 3], 1e-8);
}

TEST(TimeGradientTest, AcrossAWallOfOneElementThereIsNoSlope) {
  const Domain<3> domain{{4.0, 3.0, 4.0}, {8, 3, 8}, 1.0};
  const PartOnGrid<3> on_grid(domain, box({0, 1, 0}, {4, 2, 4}));
  const auto time =
      time_of<3>(on_grid.part, [](const Point<3>& x) { return 0.1 * x[0] + 0.2 * x[2] + 0.3 * x[1]; });
  const TimeGradient found = time_gradient(on_grid.part, time, layers_of(4));
  const double expected[] = {0.1, 0.0, 0.2};
  for (std::size_t i = 0; i < found.values.size(); ++i) EXPECT_NEAR(found.values[i], expected[i % 3], 1e-8);
}

TEST(TimeGradientTest, OfTimesNoFinerThanLayersTheFitLooksOverSeveralLayers) {
  // Tilted layers of some three elements.
  const Domain<3> domain{{12.0, 6.0, 12.0}, {12, 6, 12}, 1.0};
  const PartOnGrid<3> on_grid(domain, box({0, 0, 0}, {12, 6, 12}));
  constexpr int count = 6;
  const double tilt = 0.4, thickness = (12.0 * std::cos(tilt) + 12.0 * std::sin(tilt)) / count;
  const auto time = time_of<3>(on_grid.part, [&](const Point<3>& x) {
    return (std::floor((std::sin(tilt) * x[0] + std::cos(tilt) * x[2]) / thickness) + 0.5) / count;
  });
  const TimeGradient found = time_gradient(on_grid.part, time, layers_of(count));
  EXPECT_EQ(found.source, GradientSource::layer_differences);
  for (std::size_t e = 0; e < time.time.size(); ++e) {
    const double* g = &found.values[3 * e];
    const double length = std::hypot(g[0], g[1], g[2]);
    EXPECT_GT((std::sin(tilt) * g[0] + std::cos(tilt) * g[2]) / length, std::cos(0.25));
    EXPECT_NEAR(1.0 / (count * length * thickness), 1.0, 0.35);
  }
}

TEST(TimeGradientTest, WhatAGapSeparatesDoesNotCount) {
  // Two posts, a void element apart, in layers of two elements; the second one is built after the first.
  const Domain<2> domain{{5.0, 8.0}, {5, 8}, 1.0};
  const PartOnGrid<2> on_grid(domain, test::union_of({box({0, 0}, {2, 8}), box({3, 0}, {5, 8})}));
  const auto time = time_of<2>(on_grid.part, [](const Point<2>& x) {
    return (std::floor(x[1] / 2.0) + (x[0] > 3.0 ? 4.0 : 0.0) + 0.5) / 8.0;
  });
  const TimeGradient found = time_gradient(on_grid.part, time, layers_of(8));
  EXPECT_EQ(found.source, GradientSource::layer_differences);
  for (std::size_t e = 0; e < time.time.size(); ++e) {
    EXPECT_NEAR(found.values[2 * e], 0.0, 1e-9);
    EXPECT_GT(found.values[2 * e + 1], 0.03);
  }
}

TEST(TimeGradientTest, MultiPlanarLayersNeedNone) {
  const PartOnGrid<2> on_grid(test::odd_domain<2>(), test::block<2>());
  PseudoTime<2> time = planar_time(on_grid.part, {});
  time.gradient.clear();
  LayerDensities layers = layers_of(2);
  layers.sub_parts.density.resize(2);
  EXPECT_TRUE(time_gradient(on_grid.part, time, layers).values.empty());
}

}  // namespace
}  // namespace fabseq
