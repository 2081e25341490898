// SPDX-License-Identifier: MIT
/// Batches of any size, several sets of loads for the same layers, and lanes that fail or have nothing to do.
#include "solve/lane_elasticity.h"
#include "support/lane_elasticity_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace fabseq {
namespace {

/// Lanes first .. first + lanes - 1 of [item][lane] values.
std::vector<double> some_lanes(const std::vector<double>& values, int all, int first, int lanes) {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); i += all)
    result.insert(result.end(), values.begin() + i + first, values.begin() + i + first + lanes);
  return result;
}

/// One solver for batches of all sizes, in any order.
TYPED_TEST(LaneElasticityTest, BatchesCanHaveAnySize) {
  constexpr int Dim = TypeParam::value;
  auto settings = test::v_settings<Dim>();
  settings.layers = 8;
  const test::LayeredCase<Dim> layered(settings);
  auto lanes = layered.lanes();
  std::vector<std::vector<double>> expected;
  for (const int count : {8, 3, 1, 5, 2, 7, 4, 6}) {
    const int first = 8 - count;
    LaneVector load(layered.load.nodes, Dim, count), displacement = load;
    load.values = some_lanes(layered.load.values, 8, first, count);
    lanes.set_operators(first, count, some_lanes(layered.stiffness, 8, first, count), true);
    const auto reports = lanes.solve({&load, 1}, {&displacement, 1});
    ASSERT_EQ(reports[0].size(), static_cast<std::size_t>(count));
    for (int lane = 0; lane < count; ++lane) {
      const auto actual = layered.whole(displacement, lane);
      if (count == 8) expected.push_back(actual);
      EXPECT_TRUE(reports[0][lane].converged) << count << " " << lane;
      EXPECT_LT(test::relative_difference(actual, expected[first + lane]), test::close)
          << count << " " << lane;
    }
  }
}

/// As for the rows of an adjoint: several loads for the same layers, some of them without any.
TYPED_TEST(LaneElasticityTest, SolvesSeveralSetsOfLoads) {
  constexpr int Dim = TypeParam::value;
  const auto settings = test::v_settings<Dim>();
  const test::LayeredCase<Dim> layered(settings);
  const auto& expected = test::v_displacements<Dim>();
  auto lanes = layered.lanes();
  lanes.set_operators(0, settings.layers, layered.stiffness, true);
  std::vector<LaneVector> loads = {layered.load, layered.zeros(), layered.load}, displacements = loads;
  for (double& value : loads[2].values) value *= -3.0;
  loads[2].set_lane(1, std::vector<double>(loads[2].unknowns(), 0.0));
  const auto reports = lanes.solve(loads, displacements);
  ASSERT_EQ(reports.size(), 3u);
  test::expect_solved(layered, displacements[0], reports[0], expected);
  EXPECT_EQ(test::largest(displacements[1].values), 0.0);
  for (const SolveReport& report : reports[1]) {
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.iterations, 0);
  }
  auto scaled = expected;
  for (auto& lane : scaled)
    for (double& value : lane) value *= -3.0;
  test::expect_solved(layered, displacements[2], reports[2], scaled, {1});
  EXPECT_EQ(test::largest(layered.whole(displacements[2], 1)), 0.0);
}

/// Sets share the lanes that a small batch leaves free, few and then many, with the operators of the batch.
TYPED_TEST(LaneElasticityTest, SetsFillTheLanesThatLayersLeaveFree) {
  constexpr int Dim = TypeParam::value;
  auto settings = test::v_settings<Dim>();
  settings.layers = 5;
  const test::LayeredCase<Dim> layered(settings);
  const auto expected = test::LayeredCase<Dim>::exact(settings);
  auto lanes = layered.lanes();
  const std::size_t at_once[] = {8, 4, 2, 2, 1};
  for (const int count : {3, 1, 2, 4, 5}) {
    const int first = 5 - count;
    lanes.set_operators(first, count, some_lanes(layered.stiffness, 5, first, count), true);
    EXPECT_EQ(lanes.sets_at_once(), at_once[count - 1]);
    LaneVector load(layered.load.nodes, Dim, count);
    load.values = some_lanes(layered.load.values, 5, first, count);
    double factor = 1.0;
    for (const std::size_t sets : {1u, 2u, 11u, 1u}) {
      std::vector<LaneVector> loads(sets, load), displacements = loads;
      std::vector<double> factors;
      for (LaneVector& set : loads) {
        factors.push_back(factor *= -1.5);
        for (double& value : set.values) value *= factor;
      }
      const auto reports = lanes.solve(loads, displacements);
      ASSERT_EQ(reports.size(), sets);
      for (std::size_t set = 0; set < sets; ++set)
        for (int lane = 0; lane < count; ++lane) {
          auto scaled = expected[first + lane];
          for (double& value : scaled) value *= factors[set];
          EXPECT_TRUE(reports[set][lane].converged) << count << " " << set << " " << lane;
          EXPECT_LT(test::relative_difference(layered.whole(displacements[set], lane), scaled), test::close)
              << count << " " << set << " " << lane;
        }
    }
  }
}

/// Values at supports and where nothing is are ignored, and come back zero.
TYPED_TEST(LaneElasticityTest, ForcesAtSupportsAndOutsideDoNotMatter) {
  constexpr int Dim = TypeParam::value;
  const auto settings = test::v_settings<Dim>();
  const test::LayeredCase<Dim> layered(settings);
  auto lanes = layered.lanes();
  lanes.set_operators(0, settings.layers, layered.stiffness, true);
  LaneVector load = layered.load, displacement = layered.zeros();
  const auto ignored = [&](std::size_t unknown) {
    return layered.domain.fixed[unknown] != 0 || layered.on_grid.part.touched_nodes()[unknown / Dim] == 0;
  };
  for (std::size_t unknown = 0; unknown < load.unknowns(); ++unknown)
    for (int lane = 0; ignored(unknown) && lane < load.lanes; ++lane) {
      load(unknown, lane) = 1e3;
      displacement(unknown, lane) = 7.0;
    }
  const auto reports = lanes.solve({&load, 1}, {&displacement, 1});
  test::expect_solved(layered, displacement, reports[0], test::v_displacements<Dim>());
  for (std::size_t unknown = 0; unknown < load.unknowns(); ++unknown)
    for (int lane = 0; ignored(unknown) && lane < load.lanes; ++lane)
      EXPECT_EQ(displacement(unknown, lane), 0.0);
}

/// What `work` prints to stderr on rank 0; nothing elsewhere.
template <class Work>
std::string errors_of(Work&& work) {
  testing::internal::CaptureStderr();
  work();
  return testing::internal::GetCapturedStderr();
}

TYPED_TEST(LaneElasticityTest, LanesThatDoNotConvergeAreSolvedAgain) {
  constexpr int Dim = TypeParam::value;
  const auto settings = test::v_settings<Dim>();
  const test::LayeredCase<Dim> layered(settings);
  auto lanes = layered.lanes({}, 1e-9, 1);
  lanes.set_operators(16, settings.layers, layered.stiffness, true);
  LaneVector load = layered.load, displacement = layered.zeros();
  load.set_lane(0, std::vector<double>(load.unknowns(), 0.0));  // needs no iteration
  std::vector<std::vector<SolveReport>> reports;
  const std::string errors = errors_of([&] { reports = lanes.solve({&load, 1}, {&displacement, 1}); });
  test::expect_solved(layered, displacement, reports[0], test::v_displacements<Dim>(), {0});
  EXPECT_EQ(test::largest(layered.whole(displacement, 0)), 0.0);
  for (int lane = 0; lane < settings.layers; ++lane) {
    const bool named = errors.find("layer " + std::to_string(17 + lane) + ":") != std::string::npos;
    EXPECT_EQ(named, lane > 0 && rank_of(PETSC_COMM_WORLD) == 0) << errors;
  }
}

TYPED_TEST(LaneElasticityTest, WhatIsNoNumberIsReportedAtOnce) {
  constexpr int Dim = TypeParam::value;
  const auto settings = test::v_settings<Dim>();
  const test::LayeredCase<Dim> layered(settings);
  for (const bool in_stiffness : {false, true}) {
    LaneVector load = layered.load, displacement = layered.zeros();
    std::vector<double> stiffness = layered.stiffness;
    // Lane 1, everywhere: on the one rank or another there is something free.
    auto& spoiled = in_stiffness ? stiffness : load.values;
    for (std::size_t i = 1; i < spoiled.size(); i += settings.layers) spoiled[i] = NAN;
    auto lanes = layered.lanes();
    std::vector<std::vector<SolveReport>> reports;
    const std::string errors = errors_of([&] {
      lanes.set_operators(0, settings.layers, stiffness, true);
      reports = lanes.solve({&load, 1}, {&displacement, 1});
    });
    test::expect_solved(layered, displacement, reports[0], test::v_displacements<Dim>(), {1});
    EXPECT_FALSE(reports[0][1].converged);
    EXPECT_EQ(reports[0][1].reason, "not a number");
    EXPECT_EQ(errors, "") << "solved again";
  }
}

}  // namespace
}  // namespace fabseq
