// SPDX-License-Identifier: MIT
/// Processes with a strain of each element in each step: their adjoint against differences, and the same
/// strains from sources that tell how little they vary (docs/formulation.md 4.1,
/// docs/developer/derivatives.md 8.2).
#include "fabseq/process/built_strain.h"
#include "fabseq/process/residual_stress.h"
#include "fabseq/process/strain_source.h"
#include "support/process_case.h"
#include "support/table_strain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

/// A table that says that it varies less.
template <int Dim>
class ToldTable : public test::TableStrain<Dim> {
 public:
  ToldTable(test::TableStrain<Dim> table, StrainVariation variation)
      : test::TableStrain<Dim>(std::move(table)), variation_(variation) {}
  StrainVariation variation() const override { return variation_; }

 private:
  StrainVariation variation_;
};

constexpr int steps = 11;  // more than are solved side by side

template <int Dim>
test::TableStrain<Dim> noisy_table(const Part<Dim>& part, int salt) {
  test::TableStrain<Dim> result(part.elements().size(), steps);
  for (int step = 0; step < steps; ++step) {
    const auto strains = test::noisy_strains(part, salt + 10 * step);
    for (std::size_t e = 0; e < part.elements().size(); ++e)
      for (int c = 0; c < voigt_size<Dim>; ++c) result.entry(e, step, c) = strains[e * voigt_size<Dim> + c];
  }
  return result;
}

/// Half of the weighted squares of the displacements of a combination of the cases.
template <int Dim>
struct Functional {
  explicit Functional(const Grid<Dim>& grid)
      : weights(test::node_field(grid, Dim, [](std::int64_t i) { return test::noise(i, 3) - 0.3; })) {}

  double value(const ProcessResult& result) const {
    const std::vector<double> u =
        result.superposition->combined(result, combination(result), false).displacement;
    double total = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) total += 0.5 * weights[i] * u[i] * u[i];
    return sum(PETSC_COMM_WORLD, total);
  }
  ProcessAdjoint derivative(const ProcessResult& result) const {
    ProcessAdjoint row;
    row.combination = combination(result);
    row.displacement = result.superposition->combined(result, row.combination, false).displacement;
    for (std::size_t i = 0; i < weights.size(); ++i) row.displacement[i] *= weights[i];
    return row;
  }
  static std::vector<double> combination(const ProcessResult& result) {
    std::vector<double> factors = {0.8, 0.5, -0.3, 0.2};
    factors.resize(result.case_count());
    return factors;
  }

  std::vector<double> weights;
};

/// `cooling`: with steps in which what stands is strained.
template <int Dim>
void expect_exact_adjoint(const test::CaseSettings<Dim>& settings, bool cooling) {
  test::ProcessCase<Dim> process(settings);
  const int count = cooling ? 5 : steps;
  const LayerDensities layers = process.densities(process.wavy_time(), count, 20.0);
  const auto strains = noisy_table(process.part(), 5), direction = noisy_table(process.part(), 300);
  const Functional<Dim> functional(process.grid());
  const auto simulate = [&](const LayerDensities& densities, const StrainSource<Dim>& source) -> const auto& {
    return cooling ? process.simulate_cooling(densities, source) : process.simulate(densities, source);
  };
  const ProcessAdjoint row = functional.derivative(simulate(layers, strains));
  DensityDerivatives densities(count);
  std::vector<double> d_inputs;
  const ProcessDerivatives derivatives{&densities, &d_inputs};
  process.simulation.pull_back(layers, {&row, 1}, {&derivatives, 1});
  const double expected = test::central_difference(
      [&](double step) { return functional.value(simulate(layers, test::moved(strains, step, direction))); },
      1e-2);
  EXPECT_GT(std::abs(expected), 1e-9);
  EXPECT_NEAR(test::dot(d_inputs, direction.values), expected, 1e-7 * std::abs(expected));
  const LayerDensities towards = test::direction_of(process.part(), layers);
  for (const bool stage : {true, false}) {
    double adjoint = 0.0;
    for (int j = 0; j < count; ++j)
      adjoint += stage ? test::dot(densities.stage[j], towards.stage[j])
                       : test::dot(densities.layer[j], towards.layer[j]);
    const double by_densities = test::central_difference(
        [&](double step) {
          return functional.value(simulate(test::moved(layers, step, towards, stage), strains));
        },
        1e-3);
    EXPECT_NEAR(adjoint, by_densities, 2e-6 * std::abs(by_densities)) << stage;
  }
}

template <class T>
class StrainSourceTest : public testing::Test {};
TYPED_TEST_SUITE(StrainSourceTest, test::Dimensions);

/// With one case of strains and with several.
TYPED_TEST(StrainSourceTest, AdjointAgreesWithDifferences) {
  constexpr int Dim = TypeParam::value;
  test::CaseSettings<Dim> settings;
  expect_exact_adjoint(settings, false);
  std::vector<double> scenario(Dim, 1.0);
  scenario[0] = 1.4;
  settings.material.scenarios = {scenario};
  expect_exact_adjoint(settings, false);
  settings.process.void_model = VoidModel::quiet;
  settings.process.deposition = DepositionModel::nominal;
  expect_exact_adjoint(settings, false);
}

TYPED_TEST(StrainSourceTest, AdjointOfStepsThatCoolAgreesWithDifferences) {
  constexpr int Dim = TypeParam::value;
  test::CaseSettings<Dim> settings;
  for (const DepositionModel deposition : {DepositionModel::follow, DepositionModel::nominal}) {
    settings.process.deposition = deposition;
    expect_exact_adjoint(settings, true);
  }
}

/// A step that adds nothing strains all that stands, with its stiffness.
TYPED_TEST(StrainSourceTest, AStepThatCoolsAgreesWithDenseMatrices) {
  constexpr int Dim = TypeParam::value;
  test::ProcessCase<Dim> process(test::CaseSettings<Dim>{});
  const LayerDensities layers = process.densities(process.wavy_time(), 3, 8.0);
  process.simulate_cooling(layers, process.strain);
  const auto element = process.brute_force_element();
  const auto strain = test::strain_tensor<Dim>(process.settings.material.inherent_strain);
  for (const auto& [step, layer] : {std::pair(1, 0), std::pair(3, 1), std::pair(6, 2)}) {
    const auto stiffness = process.element_factors(layers, layer).first;
    auto system = process.dense_system(layers, layer);
    std::vector<double> load(system.size(), 0.0);
    process.grid().all_elements().for_each([&](const Index<Dim>& index, std::int64_t e) {
      for (int i = 0; i < element_unknowns<Dim>; ++i)
        load[system.unknown(index, i)] += stiffness[e] * element.strain_load(i, strain);
    });
    const auto expected = system.solve(load);
    EXPECT_GT(test::largest(expected), 0.0);
    EXPECT_LT(test::relative_difference(process.whole(process.simulation.step_increment(step)), expected),
              1e-7)
        << step;
  }
  const std::vector<double> sum = process.simulation.layer_increment(1);
  std::vector<double> of_steps = process.simulation.step_increment(2);
  add_scaled(of_steps, 1.0, process.simulation.step_increment(3));
  EXPECT_EQ(sum, of_steps);
}

/// A table of equal entries, one of entries equal in each step: whatever it says that it varies with, all
/// that comes from it is the same.
TYPED_TEST(StrainSourceTest, VariationChangesTheWayAlone) {
  constexpr int Dim = TypeParam::value;
  test::ProcessCase<Dim> process(test::CaseSettings<Dim>{});
  const LayerDensities layers = process.densities(process.wavy_time(), steps, 20.0);
  const Functional<Dim> functional(process.grid());
  for (const StrainVariation told : {StrainVariation::none, StrainVariation::by_step}) {
    test::TableStrain<Dim> table(process.part().elements().size() + 1, steps);  // at least one, on all ranks
    for (std::size_t i = 0; i < table.values.size(); ++i) {
      const auto number = static_cast<int>(i % (steps * voigt_size<Dim>));
      table.values[i] = test::some_strain<Dim>()[i % voigt_size<Dim>] +
                        (told == StrainVariation::by_step ? 0.01 * test::noise(number) : 0.0);
    }
    const ToldTable<Dim> known(table, told);
    std::vector<std::vector<double>> results[2];
    for (const bool tells : {false, true}) {
      const StrainSource<Dim>& source = tells ? static_cast<const StrainSource<Dim>&>(known) : table;
      const ProcessResult& result = process.simulate(layers, source);
      const ProcessAdjoint row = functional.derivative(result);
      DensityDerivatives densities(steps);
      std::vector<double> d_inputs;
      const ProcessDerivatives derivatives{&densities, &d_inputs};
      process.simulation.pull_back(layers, {&row, 1}, {&derivatives, 1});
      results[tells] = {result.displacement,
                        process.simulation.reactions(layers),
                        residual_stress(process.simulation, layers),
                        densities.stage[2],
                        densities.layer[2],
                        d_inputs};
    }
    for (std::size_t i = 0; i < results[0].size(); ++i)
      EXPECT_LT(test::relative_difference(results[1][i], results[0][i]), 1e-9) << i;
    if (told != StrainVariation::none) continue;
    process.simulate(layers);
    EXPECT_LT(test::relative_difference(residual_stress(process.simulation, layers), results[0][2]), 1e-9);
  }
}

/// What a result file has of the strains: those of the layers that build the elements.
TYPED_TEST(StrainSourceTest, BuiltStrainIsThatOfTheElementsLayer) {
  constexpr int Dim = TypeParam::value;
  test::TableStrain<Dim> table(3, 4);
  for (std::size_t i = 0; i < table.values.size(); ++i) table.values[i] = test::noise(static_cast<int>(i));
  const std::vector<double> layer = {2.0, 4.0, 1.0};
  const BuiltStrain own = strain_when_built<Dim>(table, layer);
  EXPECT_FALSE(own.uniform);
  ASSERT_EQ(own.values.size(), 3u * voigt_size<Dim>);
  for (std::size_t i = 0; i < own.values.size(); ++i) {
    const std::size_t e = i / voigt_size<Dim>;
    EXPECT_EQ(own.values[i], table.entry(e, static_cast<int>(layer[e]) - 1, i % voigt_size<Dim>));
  }
  MaterialSettings material;
  material.inherent_strain = test::some_strain<Dim>();
  const InherentStrain<Dim> strain(material, 1.0);
  const BuiltStrain common = strain_when_built<Dim>(strain, {});
  EXPECT_TRUE(common.uniform);
  EXPECT_EQ(common.values, test::some_strain<Dim>());
}

}  // namespace
}  // namespace fabseq
