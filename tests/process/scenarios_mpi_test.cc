// SPDX-License-Identifier: MIT
/// Scenarios of the strain: superposed from few cases, forward and adjoint (formulation 4.7).
#include "support/process_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {
namespace {

template <class T>
class ScenariosTest : public testing::Test {};
TYPED_TEST_SUITE(ScenariosTest, test::Dimensions);

template <int Dim>
std::vector<std::vector<double>> some_scenarios() {
  std::vector<std::vector<double>> result = {
      {1.0, 1.0, 1.0}, {1.15, 1.0, 1.0}, {0.9, 1.2, 1.1}, {1.0, 0.8, 1.3}};
  for (auto& scenario : result) scenario.resize(Dim);
  return result;
}

template <int Dim>
test::CaseSettings<Dim> with_scenarios(DepositionModel deposition) {
  test::CaseSettings<Dim> settings;
  settings.material.scenarios = some_scenarios<Dim>();
  settings.process.deposition = deposition;
  return settings;
}

/// The same material with a strain that a scenario is.
template <int Dim>
MaterialSettings scaled(MaterialSettings material, const std::vector<double>& axes) {
  for (int c = 0; c < voigt_size<Dim>; ++c)
    material.inherent_strain[c] *= c < Dim ? axes[c] : std::sqrt(axes[c - Dim] * axes[(c - Dim + 1) % Dim]);
  material.scenarios.clear();
  return material;
}

TYPED_TEST(ScenariosTest, AgreeWithSimulationsOfTheirOwn) {
  constexpr int Dim = TypeParam::value;
  for (const DepositionModel deposition : {DepositionModel::follow, DepositionModel::nominal}) {
    auto settings = with_scenarios<Dim>(deposition);
    test::ProcessCase<Dim> process(settings);
    process.simulation.release_with({test::exact_solver});
    const LayerDensities layers = process.densities(process.wavy_time(), 5, 12.0);
    const ProcessResult& result = process.simulate(layers);
    ASSERT_EQ(result.superposition->scenarios().size(), 4u);
    for (std::size_t s = 0; s < result.superposition->scenarios().size(); ++s) {
      settings.material = scaled<Dim>(settings.material, some_scenarios<Dim>()[s]);
      test::ProcessCase<Dim> alone(settings);
      alone.simulation.release_with({test::exact_solver});
      const ProcessResult& expected = alone.simulate(layers);
      const ProcessResult combined =
          result.superposition->combined(result, result.superposition->scenarios()[s], true);
      EXPECT_LT(test::relative_difference(combined.displacement, expected.displacement), 1e-8);
      EXPECT_LT(test::relative_difference(combined.release, expected.release), 1e-7);
      for (std::size_t block = 0; block < expected.blocks.size(); ++block)
        EXPECT_LT(
            test::relative_difference(combined.increments[block].values, expected.increments[block].values),
            1e-8);
      settings = with_scenarios<Dim>(deposition);
    }
  }
}

/// J = sum_s (s + 1) (1/2 sum_i d_i u_s,i^2 + what counts of the increments, squared, + 1/2 sum_i d_i
/// v_s,i^2).
template <int Dim>
struct SumOverScenarios {
  explicit SumOverScenarios(const Grid<Dim>& grid)
      : weights(test::node_field(grid, Dim, [](std::int64_t i) { return test::noise(i, 3) - 0.3; })) {}

  double value(const ProcessResult& result) const {
    double total = 0.0;
    for (std::size_t s = 0; s < result.superposition->scenarios().size(); ++s) {
      const ProcessResult own =
          result.superposition->combined(result, result.superposition->scenarios()[s], true);
      const double factor = static_cast<double>(s + 1);
      for (std::size_t i = 0; i < weights.size(); ++i)
        total += 0.5 * factor * weights[i] * (std::pow(own.displacement[i], 2) + std::pow(own.release[i], 2));
      for (std::size_t block = 0; block < own.blocks.size(); ++block)
        for (int lane = 0; lane < own.blocks[block].lanes; ++lane)
          for (std::size_t i = 0; i < own.increments[block].unknowns(); ++i)
            total += factor * std::pow(own.counted(block, i, lane), 2);
    }
    return sum(PETSC_COMM_WORLD, total);
  }
  std::vector<ProcessAdjoint> derivatives(const ProcessResult& result) const {
    std::vector<ProcessAdjoint> list;
    for (std::size_t s = 0; s < result.superposition->scenarios().size(); ++s) {
      const ProcessResult own =
          result.superposition->combined(result, result.superposition->scenarios()[s], true);
      const double factor = static_cast<double>(s + 1);
      ProcessAdjoint& adjoint = list.emplace_back();
      adjoint.combination = result.superposition->scenarios()[s];
      for (std::size_t i = 0; i < weights.size(); ++i) {
        adjoint.displacement.push_back(factor * weights[i] * own.displacement[i]);
        adjoint.release.push_back(factor * weights[i] * own.release[i]);
      }
      adjoint.increments = own.increments;
      for (std::size_t block = 0; block < own.blocks.size(); ++block)
        for (int lane = 0; lane < own.blocks[block].lanes; ++lane)
          for (std::size_t i = 0; i < own.increments[block].unknowns(); ++i)
            adjoint.increments[block](i, lane) = 2.0 * factor * own.counted(block, i, lane);
    }
    return list;
  }

  std::vector<double> weights;
};

/// `by_cases`: an adjoint for each case, not for each scenario.
template <int Dim>
void expect_exact_adjoint(DepositionModel deposition, bool by_cases) {
  constexpr int count = 4;
  test::ProcessCase<Dim> process(with_scenarios<Dim>(deposition));
  process.simulation.release_with({test::exact_solver});
  const LayerDensities layers = process.densities(process.wavy_time(), count, 8.0);
  const LayerDensities direction = test::direction_of(process.part(), layers);
  const SumOverScenarios<Dim> functional(process.grid());
  const ProcessResult& result = process.simulate(layers);
  auto functionals = functional.derivatives(result);
  const std::size_t cases = result.other_cases.size() + 1;
  if (by_cases) functionals = result.superposition->reduced(std::move(functionals));
  EXPECT_EQ(functionals.size(), by_cases ? std::min(cases, result.superposition->scenarios().size())
                                         : result.superposition->scenarios().size());
  DensityDerivatives derivatives(count);
  process.simulation.pull_back(layers, functionals,
                               std::vector<ProcessDerivatives>(functionals.size(), {&derivatives}));
  for (const bool stage : {true, false}) {
    const double expected = test::central_difference(
        [&](double step) {
          return functional.value(process.simulate(test::moved(layers, step, direction, stage)));
        },
        1e-3);
    double adjoint = 0.0;
    for (int j = 0; j < count; ++j)
      adjoint += stage ? test::dot(derivatives.stage[j], direction.stage[j])
                       : test::dot(derivatives.layer[j], direction.layer[j]);
    EXPECT_NEAR(adjoint, expected, 1e-6 * std::abs(expected)) << (stage ? "stage" : "layer");
  }
}

TYPED_TEST(ScenariosTest, AdjointOfASumAgreesWithDifferences) {
  expect_exact_adjoint<TypeParam::value>(DepositionModel::follow, false);
  expect_exact_adjoint<TypeParam::value>(DepositionModel::nominal, true);
}

}  // namespace
}  // namespace fabseq
