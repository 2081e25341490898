// SPDX-License-Identifier: MIT
/// Heat solves for several right-hand sides at once, against the reference path's factorization.
#include "fabseq/base/error.h"
#include "solve/lane_heat.h"
#include "support/heat_case.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace fabseq {
namespace {

/// 37 x 23 or 37 x 11 x 23 nearly cubic elements, so that every level is padded; prescribed on a part of the
/// lower face.
template <int Dim>
struct HeatCase {
  explicit HeatCase(MPI_Comm comm = PETSC_COMM_WORLD) : grid(comm, whole(), {}) {
    const Index<Dim> last = grid.domain().elements;
    grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t) {
      domain.first_corners.push_back(grid.first_corner(index));
    });
    grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
      domain.fixed.push_back(node[Dim - 1] == 0 && 3 * node[0] < last[0] ? 1 : 0);
    });
  }
  static Domain<Dim> whole() {
    if constexpr (Dim == 2)
      return {{3.7, 2.1}, {37, 23}, 0.25};
    else
      return {{3.7, 1.2, 2.1}, {37, 11, 23}, 1.0};
  }
  std::unique_ptr<LaneHeat<Dim>> lanes(bool lumped, double tolerance, int max_iterations = 100) const {
    return std::make_unique<LaneHeat<Dim>>(
        grid, domain, lumped, max_iterations,
        AssembledSolverSettings{ReferenceMethod::direct, tolerance, 1000, "heat_"});
  }
  /// From 1e-3 to 1, rough.
  std::vector<double> diffusivity() const {
    std::vector<double> result;
    grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t) {
      result.push_back(std::pow(10.0, -3.0 * test::noise(grid.all_elements().offset(index))));
    });
    return result;
  }
  /// Blocks of up to 8 right-hand sides, half of them smooth.
  std::vector<LaneVector> loads(int count) const {
    std::vector<LaneVector> result;
    for (int first = 0; first < count; first += widest_block) {
      const int lanes = std::min(widest_block, count - first);
      LaneVector& block = result.emplace_back(static_cast<int>(grid.owned_nodes().count()), 1, lanes);
      grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
        for (int lane = 0; lane < lanes; ++lane) {
          const double x = grid.node_position(node)[0];
          block(offset, lane) = lane % 2 == 0 ? test::noise(grid.all_nodes().offset(node), first + lane) - 0.3
                                              : std::cos((first + lane) * x);
        }
      });
    }
    return result;
  }
  std::vector<double> whole_lane(const LaneVector& block, int lane) const {
    return test::whole_field<Dim>(grid.comm(), grid.owned_nodes(), grid.all_nodes(), block.lane(lane));
  }

  Grid<Dim> grid;
  SystemDomain domain;
};

constexpr double reaction = 0.4;

template <class T>
class LaneHeatTest : public testing::Test {};
TYPED_TEST_SUITE(LaneHeatTest, test::Dimensions);

TYPED_TEST(LaneHeatTest, AgreesWithAFactorization) {
  constexpr int Dim = TypeParam::value;
  const HeatCase<Dim> heat;
  for (const bool lumped : {false, true}) {
    const auto lanes = heat.lanes(lumped, 1e-11);
    ReferenceHeat<Dim> reference(heat.grid, heat.domain, lumped,
                                 {ReferenceMethod::direct, 1e-13, 1000, "heat_"});
    lanes->set_operator(heat.diffusivity(), reaction);
    reference.set_operator(heat.diffusivity(), reaction);
    for (const int count : {1, 3, 8, 11}) {
      const auto loads = heat.loads(count);
      auto solutions = loads, expected = loads;
      const auto reports = lanes->solve(loads, solutions);
      (void)reference.solve(loads, expected);
      ASSERT_EQ(reports.size(), static_cast<std::size_t>(count));
      for (const SolveReport& report : reports) {
        EXPECT_TRUE(report.converged) << report.reason;
        EXPECT_GT(report.iterations, 0);
        EXPECT_LE(report.iterations, 30);
        EXPECT_LE(report.residual, 1e-11);
      }
      for (std::size_t block = 0; block < loads.size(); ++block)
        for (int lane = 0; lane < loads[block].lanes; ++lane)
          EXPECT_LT(test::relative_difference(heat.whole_lane(solutions[block], lane),
                                              heat.whole_lane(expected[block], lane)),
                    1e-9)
              << count << ' ' << block << ' ' << lane;
    }
  }
}

/// A step of conduction in time: elements that hold and conduct a millionth, and a film at some nodes, which
/// takes more than their elements hold.
TYPED_TEST(LaneHeatTest, ReactionsAndADiagonalVary) {
  constexpr int Dim = TypeParam::value;
  const HeatCase<Dim> heat;
  const auto lanes = heat.lanes(true, 1e-11);
  ReferenceHeat<Dim> reference(heat.grid, heat.domain, true, {ReferenceMethod::direct, 1e-13, 1000, "heat_"});
  std::vector<double> diffusivity, capacity, film;
  heat.grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t) {
    const double share = index[Dim - 1] < 12 ? 1.0 : 1e-6;
    diffusivity.push_back(0.3 * share);
    capacity.push_back(share);
  });
  heat.grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
    const double places = test::noise(heat.grid.all_nodes().offset(node), 7);
    film.push_back(node[Dim - 1] == 12 ? 3.0 * places * heat.grid.element_volume() : 0.0);
  });
  for (auto* solver : {static_cast<HeatSolver<Dim>*>(lanes.get()), static_cast<HeatSolver<Dim>*>(&reference)})
    solver->set_operator(HeatOperator{diffusivity, capacity, film});
  for (const int count : {1, 8}) {
    const auto loads = heat.loads(count);
    auto solutions = loads, expected = loads;
    for (const SolveReport& report : lanes->solve(loads, solutions)) {
      EXPECT_TRUE(report.converged) << report.reason;
      EXPECT_LE(report.iterations, 40);
    }
    (void)reference.solve(loads, expected);
    for (int lane = 0; lane < count; ++lane)
      EXPECT_LT(
          test::relative_difference(heat.whole_lane(solutions[0], lane), heat.whole_lane(expected[0], lane)),
          1e-8);
  }
}

/// The operator can be set again, also after solves with other numbers of right-hand sides.
TYPED_TEST(LaneHeatTest, FollowsTheOperator) {
  constexpr int Dim = TypeParam::value;
  const HeatCase<Dim> heat;
  const auto lanes = heat.lanes(true, 1e-11);
  const auto one = heat.loads(1), eight = heat.loads(8);
  auto solution = one, before = one, others = eight;
  lanes->set_operator(heat.diffusivity(), reaction);
  (void)lanes->solve(one, before);
  (void)lanes->solve(eight, others);
  std::vector<double> twice = heat.diffusivity();
  for (double& value : twice) value *= 2.0;
  lanes->set_operator(twice, 2.0 * reaction);
  (void)lanes->solve(one, solution);
  (void)lanes->solve(eight, others);
  auto expected = heat.whole_lane(before[0], 0);
  for (double& value : expected) value *= 0.5;
  EXPECT_LT(test::relative_difference(heat.whole_lane(solution[0], 0), expected), 1e-10);
  EXPECT_LT(test::relative_difference(heat.whole_lane(others[0], 0), expected), 1e-10);
}

/// On all ranks together and on each by itself.
TYPED_TEST(LaneHeatTest, IterationsDoNotDependOnTheRanks) {
  constexpr int Dim = TypeParam::value;
  const auto reports = [](const HeatCase<Dim>& heat) {
    const auto lanes = heat.lanes(false, 1e-9);
    lanes->set_operator(heat.diffusivity(), reaction);
    const auto loads = heat.loads(11);
    auto solutions = loads;
    return lanes->solve(loads, solutions);
  };
  const auto together = reports(HeatCase<Dim>());
  const auto alone = reports(HeatCase<Dim>(PETSC_COMM_SELF));
  ASSERT_EQ(together.size(), alone.size());
  for (std::size_t i = 0; i < together.size(); ++i)
    EXPECT_NEAR(together[i].iterations, alone[i].iterations, 1) << i;
}

TYPED_TEST(LaneHeatTest, NothingComesFromNothing) {
  constexpr int Dim = TypeParam::value;
  const HeatCase<Dim> heat;
  const auto lanes = heat.lanes(false, 1e-9);
  lanes->set_operator(heat.diffusivity(), reaction);
  for (const int count : {1, 3}) {
    auto loads = heat.loads(count);
    loads[0].set_lane(0, std::vector<double>(loads[0].unknowns(), 0.0));
    auto solutions = loads;
    const auto reports = lanes->solve(loads, solutions);
    EXPECT_TRUE(reports[0].converged);
    EXPECT_EQ(reports[0].iterations, 0);
    EXPECT_EQ(reports[0].residual, 0.0);
    EXPECT_EQ(test::largest(heat.whole_lane(solutions[0], 0)), 0.0);
    for (int lane = 1; lane < count; ++lane) {
      EXPECT_TRUE(reports[lane].converged);
      EXPECT_GT(reports[lane].iterations, 0);
    }
  }
}

TYPED_TEST(LaneHeatTest, WhatIsNoNumberIsReportedAtOnce) {
  constexpr int Dim = TypeParam::value;
  const HeatCase<Dim> heat;
  const auto lanes = heat.lanes(false, 1e-9);
  const auto loads = heat.loads(11);
  auto solutions = loads;
  // A single element of the first rank.
  auto diffusivity = heat.diffusivity();
  if (rank_of(PETSC_COMM_WORLD) == 0) diffusivity[5] = NAN;
  lanes->set_operator(diffusivity, reaction);
  for (const SolveReport& report : lanes->solve(loads, solutions)) {
    EXPECT_FALSE(report.converged);
    EXPECT_EQ(report.iterations, 0);
    EXPECT_EQ(report.reason, "not a number");
  }
  // A single right-hand side: the others are solved for.
  auto spoilt = loads;
  if (rank_of(PETSC_COMM_WORLD) == 0) spoilt[0](spoilt[0].nodes - 1, 2) = NAN;
  lanes->set_operator(heat.diffusivity(), reaction);
  const auto reports = lanes->solve(spoilt, solutions);
  for (int i = 0; i < 11; ++i) {
    EXPECT_EQ(reports[i].converged, i != 2) << i;
    EXPECT_EQ(reports[i].reason, i == 2 ? "not a number" : "") << i;
  }
}

TYPED_TEST(LaneHeatTest, WhatDoesNotConvergeIsSolvedByTheReferencePath) {
  constexpr int Dim = TypeParam::value;
  const HeatCase<Dim> heat;
  const auto few = heat.lanes(false, 1e-11, 3);
  const auto enough = heat.lanes(false, 1e-11);
  auto loads = heat.loads(11);
  loads[1].set_lane(1, std::vector<double>(loads[1].unknowns(), 0.0));
  auto solutions = loads, expected = loads;
  enough->set_operator(heat.diffusivity(), reaction);
  (void)enough->solve(loads, expected);
  testing::internal::CaptureStderr();
  few->set_operator(heat.diffusivity(), reaction);
  const auto reports = few->solve(loads, solutions);
  const std::string warning = testing::internal::GetCapturedStderr();
  if (rank_of(PETSC_COMM_WORLD) == 0) {
    EXPECT_NE(warning.find("10 of 11 solves"), std::string::npos) << warning;
    EXPECT_EQ(std::count(warning.begin(), warning.end(), '\n'), 1) << warning;
  }
  for (const SolveReport& report : reports) EXPECT_TRUE(report.converged);
  for (std::size_t block = 0; block < loads.size(); ++block)
    for (int lane = 0; lane < loads[block].lanes; ++lane)
      EXPECT_LT(test::relative_difference(heat.whole_lane(solutions[block], lane),
                                          heat.whole_lane(expected[block], lane)),
                1e-9);
}

/// Lanes and reference path, with as many rows as make a whole block, a few or several blocks.
TYPED_TEST(LaneHeatTest, PathsAgree) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const Part<Dim>& part = on_grid.part;
  const auto design = test::noise_field(part, 0.05, 0.9);
  auto lanes = test::heat_sequence<Dim>(part, test::heat_settings(MassRule::lumped), 0.0, SolverPath::lanes);
  auto reference = test::heat_sequence<Dim>(part, test::heat_settings(MassRule::lumped));
  const auto& time = lanes.update(design);
  EXPECT_LT(test::relative_difference(
                test::whole_node_field<Dim>(on_grid.grid, time.temperature),
                test::whole_node_field<Dim>(on_grid.grid, reference.update(design).temperature)),
            1e-11);
  for (const int count : {0, 3, 8, 19}) {
    const std::vector<TimeDerivatives> rows = test::time_functionals(part, count);
    const auto gradients = lanes.pull_back(rows);
    const auto expected = reference.pull_back(rows);
    ASSERT_EQ(gradients.size(), rows.size());
    EXPECT_EQ(lanes.adjoint_iterations().size(), rows.size());
    for (int row = 0; row < count; ++row)
      EXPECT_LT(test::relative_difference(test::whole_part_field(part, gradients[row]),
                                          test::whole_part_field(part, expected[row])),
                1e-10)
          << row << " of " << count;
  }
}

TYPED_TEST(LaneHeatTest, ADesignThatIsNoNumberIsANumericalFailure) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const auto design =
      test::part_field(on_grid.part, [](std::int64_t number) { return number == 0 ? NAN : 0.1; });
  for (const SolverPath path : {SolverPath::lanes, SolverPath::reference}) {
    auto sequence = test::heat_sequence<Dim>(on_grid.part, test::heat_settings(MassRule::lumped), 0.0, path);
    EXPECT_THROW((void)sequence.update(design), NumericalError);
  }
}

}  // namespace
}  // namespace fabseq
