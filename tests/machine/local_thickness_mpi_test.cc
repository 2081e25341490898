// SPDX-License-Identifier: MIT
/// Build direction and local thickness of curved and of multi-planar layers (docs/formulation.md 13.1).
#include "fabseq/machine/build_direction.h"
#include "fabseq/machine/local_thickness.h"
#include "fabseq/machine/meeting_fronts.h"
#include "fabseq/sequence/given_sequence.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fabseq {
namespace {

TEST(LocalThicknessTest, OfPlanarLayersIsTheirThickness) {
  const test::PartOnGrid<3> on_grid(test::odd_domain<3>(), test::block<3>());
  const Part<3>& part = on_grid.part;
  const PseudoTime<3> time = planar_time(part, {1.0, 0.0, 1.0});
  LayerDensities layers;
  layers.time_points = {0.0, 0.25, 1.0};
  std::vector<double> layer;
  for (const double t : time.time) layer.push_back(t < 0.25 ? 1.0 : 2.0);

  const std::vector<double> thickness = local_thickness<3>(time.time, time.gradient, layers, layer);
  const double height = planar_height<3>(part, {1.0, 0.0, 1.0});
  for (std::size_t e = 0; e < layer.size(); ++e)
    EXPECT_NEAR(thickness[e], (layer[e] == 1.0 ? 0.25 : 0.75) * height, 1e-12);
  const std::array<double, 2> allowed{0.1 * height, 0.5 * height};
  const std::vector<double> meetings = meeting_fronts<3>(part, time.time, time.gradient);
  EXPECT_EQ(std::count(meetings.begin(), meetings.end(), 0.0), static_cast<std::ptrdiff_t>(layer.size()));
  const auto range = thickness_range<3>(part, thickness, time.gradient, meetings, allowed, layer, 2);
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->least, 0.25 * height, 1e-12);
  EXPECT_NEAR(range->largest, 0.75 * height, 1e-12);
  EXPECT_FALSE(range->largest_is_meeting);
  EXPECT_NEAR(range->worst, 0.75 * height, 1e-12);
  const double second =
      sum(part.grid().comm(), static_cast<double>(std::count(layer.begin(), layer.end(), 2.0)));
  EXPECT_NEAR(range->outside->share, second / static_cast<double>(part.count()), 1e-12);
  EXPECT_EQ(range->outside->per_layer, (std::vector<std::int64_t>{0, static_cast<std::int64_t>(second)}));
  EXPECT_NEAR(range->outside->largest, 0.5, 1e-12);  // 0.75 in place of 0.5
  EXPECT_FALSE(thickness_range<3>(part, thickness, time.gradient, meetings, std::nullopt, layer, 2)->outside);

  const std::vector<double> direction = build_direction<3>(time.gradient, layers, layer);
  for (std::size_t i = 0; i < direction.size(); ++i)
    EXPECT_NEAR(direction[i], i % 3 == 1 ? 0.0 : std::sqrt(0.5), 1e-12);
}

TEST(LocalThicknessTest, IsNotDefinedWithoutGradientOrTimePoints) {
  const test::PartOnGrid<2> on_grid(test::odd_domain<2>(), test::block<2>());
  const Part<2>& part = on_grid.part;
  PseudoTime<2> time = planar_time(part, {});
  const std::vector<double> layer(time.time.size(), 1.0);
  EXPECT_FALSE(thickness_range<2>(part, local_thickness<2>(time.time, time.gradient, LayerDensities{}, layer),
                                  {}, {}, std::nullopt, layer, 1));
  time.gradient.clear();
  LayerDensities layers;
  layers.time_points = {0.0, 1.0};
  EXPECT_FALSE(thickness_range<2>(part, local_thickness<2>(time.time, time.gradient, layers, layer), {}, {},
                                  std::nullopt, layer, 1));
  EXPECT_TRUE(build_direction<2>(time.gradient, layers, layer).empty());
}

/// The last layer holds what is later, however high that is, and no layer is thicker than the part.
TEST(LocalThicknessTest, ReachesToElementsBeyondTheLayersAndHasAnEnd) {
  const test::PartOnGrid<2> on_grid(test::odd_domain<2>(), test::block<2>());
  const Part<2>& part = on_grid.part;
  PseudoTime<2> time;
  const std::size_t count = part.elements().size();
  LayerDensities layers;
  layers.time_points = {0.0, 0.5, 1.0};
  const std::vector<double> times = {-0.25, 0.3, 1.0, 1.75}, layer_of = {1, 1, 2, 2},
                            lengths = {0.75, 0.5, 0.5, 1.25};
  std::vector<double> layer, expected;
  std::int64_t flat = 0;
  for (std::size_t e = 0; e < count; ++e) {
    const bool has_gradient = e % 5 != 0;
    time.time.push_back(times[e % 4]);
    time.gradient.insert(time.gradient.end(), {has_gradient ? 3.0 : 0.0, has_gradient ? 4.0 : 1e-200});
    layer.push_back(layer_of[e % 4]);
    expected.push_back(has_gradient ? lengths[e % 4] / 5.0 : part.longest_edge());
    flat += has_gradient ? 0 : 1;
  }
  const std::vector<double> thickness =
      local_thickness<2>(time.time, time.gradient, layers, layer, part.longest_edge());
  for (std::size_t e = 0; e < count; ++e) EXPECT_NEAR(thickness[e], expected[e], 1e-12) << time.time[e];
  const auto range =
      thickness_range<2>(part, thickness, time.gradient, meeting_fronts<2>(part, time.time, time.gradient),
                         std::nullopt, layer, 2);
  EXPECT_EQ(range->without_end.elements, sum(part.grid().comm(), flat));
  EXPECT_EQ(range->largest, part.longest_edge());
}

/// A layer as thick as the part is long is no place without a gradient.
TEST(LocalThicknessTest, OfOneLayerIsThePartsHeight) {
  const Domain<2> domain{{1.0, 4.0}, {2, 8}, 1.0};
  const test::PartOnGrid<2> on_grid(domain, test::box({0, 0}, {1, 4}));
  const PseudoTime<2> time = planar_time(on_grid.part, {0.0, 1.0});
  LayerDensities layers;
  layers.time_points = {0.0, 1.0};
  const std::vector<double> layer(time.time.size(), 1.0);
  const auto thickness =
      local_thickness<2>(time.time, time.gradient, layers, layer, on_grid.part.longest_edge());
  const auto range =
      thickness_range<2>(on_grid.part, thickness, time.gradient,
                         meeting_fronts<2>(on_grid.part, time.time, time.gradient), std::nullopt, layer, 1);
  EXPECT_NEAR(range->largest, 4.0, 1e-12);
  EXPECT_EQ(range->without_end.elements, 0);
}

TEST(MeetingFrontsTest, AreWhereTheGradientVanishesBetweenSteepNeighbours) {
  const test::PartOnGrid<2> on_grid(test::odd_domain<2>(), test::block<2>());
  const Part<2>& part = on_grid.part;
  PseudoTime<2> time;
  std::vector<double> middle;
  for (const int element : part.elements()) {
    const double x = part.grid().element_center(part.grid().owned_elements().index(element))[0] - 1.75;
    const bool in_middle = std::abs(x) < 0.1;
    time.time.push_back(1.0 - 0.2 * std::abs(x));
    time.gradient.push_back(in_middle ? 0.0 : x > 0.0 ? -0.2 : 0.2);
    time.gradient.push_back(0.0);
    middle.push_back(in_middle ? 1.0 : 0.0);
  }
  EXPECT_EQ(meeting_fronts<2>(part, time.time, time.gradient), middle);
  LayerDensities layers;
  layers.time_points = {0.0, 1.0};
  const std::vector<double> layer(time.time.size(), 1.0);
  const std::vector<double> thickness = local_thickness<2>(time.time, time.gradient, layers, layer);
  const auto range = thickness_range<2>(part, thickness, time.gradient, middle, std::nullopt, layer, 1);
  EXPECT_TRUE(range->largest_is_meeting);
  EXPECT_NEAR(range->largest_at.at(0), 1.75, 1e-12);
  time.gradient.clear();
  EXPECT_TRUE((meeting_fronts<2>(part, time.time, time.gradient).empty()));
}

TEST(BuildDirectionTest, OfMultiPlanarLayersIsTheirPrintDirection) {
  const test::PartOnGrid<2> on_grid(test::odd_domain<2>(), test::block<2>());
  const PseudoTime<2> time = planar_time(on_grid.part, {});
  LayerDensities layers;
  layers.sub_parts.density.resize(2);
  layers.sub_parts.directions = {0.0, 1.0, 0.6, 0.8};
  layers.sub_parts.of_layer = {0, 1, 1};
  std::vector<double> layer;
  for (std::size_t e = 0; e < time.time.size(); ++e) layer.push_back(1.0 + static_cast<double>(e % 3));
  const std::vector<double> direction = build_direction<2>(time.gradient, layers, layer);
  for (std::size_t e = 0; e < layer.size(); ++e) {
    EXPECT_EQ(direction[2 * e], layer[e] == 1.0 ? 0.0 : 0.6);
    EXPECT_EQ(direction[2 * e + 1], layer[e] == 1.0 ? 1.0 : 0.8);
  }
}

}  // namespace
}  // namespace fabseq
