// SPDX-License-Identifier: MIT
/// The process with plastic flow against Newton's method, which takes one step after the other (formulation
/// 16).
#include "support/flow_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace fabseq {
namespace {

std::vector<double> stresses(const std::vector<test::FlowState>& states) {
  std::vector<double> result;
  for (const test::FlowState& state : states)
    result.insert(result.end(), state.stress.begin(), state.stress.end());
  return result;
}

std::vector<double> plastic_strains(const std::vector<test::FlowState>& states) {
  std::vector<double> result;
  for (const test::FlowState& state : states) result.push_back(state.plastic_strain);
  return result;
}

/// Close to the solution each correction is at most a number times the square of the one before. Returns how
/// many pairs of corrections showed that.
int expect_quadratic(const std::vector<double>& corrections) {
  constexpr double close = 1e-3, most = 100.0, rounding = 1e-12;
  int result = 0;
  for (std::size_t i = 1; i < corrections.size(); ++i) {
    if (corrections[i - 1] > close || corrections[i - 1] < std::sqrt(rounding)) continue;
    EXPECT_LE(corrections[i], most * std::pow(corrections[i - 1], 2) + rounding);
    ++result;
  }
  return result;
}

void expect_same(const LockedIn& found, const std::vector<test::FlowState>& expected, const Grid<3>& grid) {
  EXPECT_LT(
      test::relative_difference(test::whole_element_field<3>(grid, found.stress, 6), stresses(expected)),
      1e-8);
  EXPECT_LT(test::relative_difference(test::whole_element_field<3>(grid, found.plastic_strain),
                                      plastic_strains(expected)),
            1e-8);
}

/// Compares all increments, and the states before and after the release. Returns how much the release flows,
/// relative to what has flowed before.
double compare(const test::FlowCase& flow) {
  const Grid<3>& grid = flow.process.grid();
  const auto process = test::plastic_process(flow.process, 1e-9, /*released=*/true);
  const ProcessResult& found = process->simulate(flow.input(flow.steps.size()));
  const LockedIn built = process->locked_in(flow.layers);
  const test::FlowElement element(grid.spacing(), flow.process.settings.material.poisson);
  test::NewtonFlow newton(grid.domain().elements, element, flow.held());
  int quadratic = 0;
  for (std::size_t step = 0; step < flow.steps.size(); ++step) {
    const std::vector<double> expected = newton.advance(flow.materials[step], /*released=*/false);
    quadratic += expect_quadratic(newton.decrements());
    EXPECT_LT(test::relative_difference(flow.process.whole(process->step_increment(static_cast<int>(step))),
                                        expected),
              1e-8)
        << "step " << step;
  }
  EXPECT_GT(quadratic, 4);
  expect_same(built, newton.states(), grid);
  const std::vector<double> flowed = plastic_strains(newton.states());
  const double yield_strain =
      *flow.process.settings.material.yield_stress / flow.process.settings.material.young;
  EXPECT_GT(test::largest(flowed), 2.0 * yield_strain);
  const std::vector<double> release = newton.advance(flow.materials.back(), /*released=*/true);
  EXPECT_LT(test::relative_difference(flow.process.whole(found.release), release), 1e-7);
  expect_same(process->released(built, found.release), newton.states(), grid);
  return test::relative_difference(plastic_strains(newton.states()), flowed);
}

/// More steps than are solved at once, with grey layers.
TEST(PlasticNewtonTest, AtOneTemperature) { (void)compare(test::FlowCase(test::flowing_case(), 10, 12.0)); }

TEST(PlasticNewtonTest, WithTemperatures) {
  EXPECT_GT(compare(test::FlowCase(test::heated_case(), 5, 12.0)), 1e-4);
}

TEST(PlasticNewtonTest, InAVoidThatIsThere) {
  test::CaseSettings<3> settings = test::heated_case();
  settings.process.void_model = VoidModel::quiet;
  (void)compare(test::FlowCase(settings, 2, 12.0));
}

}  // namespace
}  // namespace fabseq
