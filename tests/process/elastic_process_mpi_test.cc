// SPDX-License-Identifier: MIT
/// The layer-by-layer simulation against dense matrices and exact solutions, its adjoint against differences
/// (docs/formulation.md 4.1, docs/developer/derivatives.md 8.2).
#include "fabseq/process/elastic_process.h"
#include "fabseq/solve/solvers.h"
#include "support/process_case.h"
#include "support/table_strain.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <class T>
class ElasticProcessTest : public testing::Test {};
TYPED_TEST_SUITE(ElasticProcessTest, test::Dimensions);

TYPED_TEST(ElasticProcessTest, AgreesWithDenseMatrices) {
  constexpr int Dim = TypeParam::value;
  for (auto settings : test::void_models<Dim>()) {
    settings.process.stiffness_penalty = 2.5;
    test::ProcessCase<Dim> process(settings);
    // More layers than are solved side by side.
    const LayerDensities layers = process.densities(process.wavy_time(), 10, 25.0);
    const auto expected = process.dense_increments(layers);
    const ProcessResult& result = process.simulate(layers);
    ASSERT_EQ(result.iterations.size(), 10u);
    std::vector<double> total(expected[0].size(), 0.0);
    for (int j = 0; j < 10; ++j) {
      const auto increment = process.whole(process.simulation.layer_increment(j));
      EXPECT_LT(test::relative_difference(increment, expected[j]), 1e-7) << j;
      for (std::size_t i = 0; i < total.size(); ++i) total[i] += expected[j][i];
    }
    EXPECT_LT(test::relative_difference(process.whole(result.displacement), total), 1e-7);
  }
}

/// Factors of the layers that leave strains as they are.
template <int Dim>
std::vector<double> ones(int layers) {
  return std::vector<double>(static_cast<std::size_t>(layers) * voigt_size<Dim>, 1.0);
}

/// Every element with a strain of its own, and with a substrate on clamps.
TYPED_TEST(ElasticProcessTest, StrainsOfTheElementsAgreeWithDenseMatrices) {
  constexpr int Dim = TypeParam::value;
  auto cases = test::void_models<Dim>();
  for (const auto& settings : test::clamped_cases<Dim>()) cases.push_back(settings);
  for (const auto& settings : cases) {
    test::ProcessCase<Dim> process(settings);
    const LayerDensities layers = process.densities(process.wavy_time(), 3, 12.0);
    const std::vector<double> strains = test::noisy_strains(process.part());
    std::vector<double> expected;
    for (const auto& increment :
         process.dense_increments(layers, test::whole_strains(process.part(), strains))) {
      expected.resize(increment.size(), 0.0);
      for (std::size_t i = 0; i < increment.size(); ++i) expected[i] += increment[i];
    }
    const auto table = test::product_strain<Dim>(strains, ones<Dim>(3));
    const auto actual = process.whole(process.simulate(layers, table).displacement);
    EXPECT_GT(test::largest(actual), 1e-4);
    EXPECT_LT(test::relative_difference(actual, expected), 1e-7);
  }
}

/// Every element with a strain and every layer with factors; more layers than are solved side by side.
TYPED_TEST(ElasticProcessTest, FactorsOfTheLayersAgreeWithDenseMatrices) {
  constexpr int Dim = TypeParam::value;
  auto cases = test::void_models<Dim>();
  for (const auto& settings : test::clamped_cases<Dim>()) cases.push_back(settings);
  for (const auto& settings : cases) {
    test::ProcessCase<Dim> process(settings);
    const LayerDensities layers = process.densities(process.wavy_time(), 11, 40.0);
    const std::vector<double> strains = test::noisy_strains(process.part());
    std::vector<double> factors;
    for (int i = 0; i < 11 * voigt_size<Dim>; ++i) factors.push_back(2.0 * test::noise(i) - 1.0);
    const auto table = test::product_strain<Dim>(strains, factors);
    process.simulate(layers, table);
    for (int j = 0; j < 11; ++j) {
      std::vector<double> of_elements = test::whole_strains(process.part(), strains);
      for (std::size_t i = 0; i < of_elements.size(); ++i)
        of_elements[i] *= factors[j * voigt_size<Dim> + i % voigt_size<Dim>];
      const auto system = process.dense_system(layers, j);
      const auto expected = system.solve(process.dense_load(layers, j, system, of_elements));
      EXPECT_LT(test::relative_difference(process.whole(process.simulation.layer_increment(j)), expected),
                1e-7)
          << j;
    }
  }
}

/// A strain along the normal of planar layers fits the plate and all layers without stress: what is below
/// stays, the layer stretches, and what is above follows as a whole (void absent), overhanging or not.
TYPED_TEST(ElasticProcessTest, NormalStrainOfPlanarLayersAddsUpExactly) {
  constexpr int Dim = TypeParam::value;
  const double strain = -0.013;
  for (const BuildPlate plate : {BuildPlate{Dim - 1, false}, BuildPlate{0, true}})
    for (const Shape& shape : {test::block<Dim>(), test::gallows<Dim>()})
      for (const int count : {1, 2, 5}) {
        // On a plate at the upper end of x the gallows stands on its arm.
        if (plate.axis == 0 && shape.kind != Shape::Kind::box) continue;
        test::CaseSettings<Dim> settings;
        settings.shape = shape;
        settings.plate = plate;
        settings.material.inherent_strain.assign(voigt_size<Dim>, 0.0);
        settings.material.inherent_strain[plate.axis] = strain;
        test::ProcessCase<Dim> process(settings);
        const LayerDensities layers = process.densities(process.planar_time(), count, 10.0, true);
        const auto u = process.simulate(layers).displacement;
        const double scale = std::abs(strain) * process.grid().domain().size[plate.axis];
        process.grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
          const bool there = process.part().touched_nodes()[offset] != 0;
          const double sign = plate.upper ? -1.0 : 1.0;
          for (int a = 0; a < Dim; ++a) {
            const double stretch = sign * strain * process.height(process.grid().node_position(node));
            EXPECT_NEAR(u[offset * Dim + a], there && a == plate.axis ? stretch : 0.0, 1e-9 * scale);
          }
        });
      }
}

/// Warm solves of systems that have hardly changed take few steps, and lead to the same displacements.
TYPED_TEST(ElasticProcessTest, BeginsWithTheLastSolutions) {
  constexpr int Dim = TypeParam::value;
  test::ProcessCase<Dim> process(test::CaseSettings<Dim>{});
  const ElasticModel<Dim>& model = process.model;
  SolveTolerance tolerance{1e-3};
  ElasticProcess<Dim> lanes(
      model,
      make_elasticity_solver(SolverSettings{}, process.grid(), model.domain, model.element,
                             model.material.poisson, tolerance.value, widest_block),
      process.groups, BlockSolver::lanes);
  const auto steps = [&](const LayerDensities& layers) {
    int result = 0;
    for (const int iterations : lanes.simulate(layers, process.strain).iterations) result += iterations;
    return result;
  };
  const LayerDensities first = process.densities(process.wavy_time(), 10, 25.0);
  const LayerDensities next = process.densities(process.wavy_time(), 10, 25.001);
  const int cold = steps(next);
  tolerance.warm = true;
  lanes.set_tolerance(tolerance);
  EXPECT_NEAR(steps(next), cold, 0.2 * cold);  // what is known of the spectrum may take a step more
  steps(first);
  EXPECT_LT(2 * steps(next), cold);
  const auto expected = process.whole(process.simulate(next).displacement);
  EXPECT_LT(
      test::relative_difference(process.whole(lanes.simulate(next, process.strain).displacement), expected),
      1e-2);
  lanes.start_cold();
  EXPECT_NEAR(steps(next), cold, 0.2 * cold);
}

TYPED_TEST(ElasticProcessTest, AnEmptyLayerAddsNothing) {
  constexpr int Dim = TypeParam::value;
  test::ProcessCase<Dim> process(test::CaseSettings<Dim>{});
  auto time = process.planar_time();
  for (double& t : time) t = t < 0.5 ? 0.1 : 0.9;
  const ProcessResult& result = process.simulate(process.densities(time, 3, 10.0, true));
  EXPECT_EQ(test::largest(process.simulation.layer_increment(1)), 0.0);
  EXPECT_EQ(result.iterations[1], 0);
  EXPECT_GT(max(PETSC_COMM_WORLD, test::largest(process.simulation.layer_increment(2))), 1e-4);
}

TYPED_TEST(ElasticProcessTest, DoesNotDependOnYoungsModulus) {
  constexpr int Dim = TypeParam::value;
  test::CaseSettings<Dim> settings;
  test::ProcessCase<Dim> unit(settings);
  settings.material.young = 210e3;
  test::ProcessCase<Dim> steel(settings);
  const LayerDensities layers = unit.densities(unit.wavy_time(), 3, 12.0);
  const auto expected = unit.whole(unit.simulate(layers).displacement);
  const auto actual = steel.whole(steel.simulate(layers).displacement);
  EXPECT_LT(test::relative_difference(actual, expected), 1e-11);
}

TYPED_TEST(ElasticProcessTest, IsLinearInTheStrain) {
  constexpr int Dim = TypeParam::value;
  const auto displacement = [&](double isotropic, double other) {
    test::CaseSettings<Dim> settings;
    for (int c = 0; c < voigt_size<Dim>; ++c)
      settings.material.inherent_strain[c] =
          isotropic * test::isotropic_strain<Dim>(-0.01)[c] + other * test::some_strain<Dim>()[c];
    test::ProcessCase<Dim> process(settings);
    const LayerDensities layers = process.densities(process.wavy_time(), 3, 12.0);
    return process.whole(process.simulate(layers).displacement);
  };
  const auto a = displacement(1.0, 0.0), b = displacement(0.0, 1.0);
  std::vector<double> expected(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) expected[i] = 2.0 * a[i] - 3.0 * b[i];
  EXPECT_LT(test::relative_difference(displacement(2.0, -3.0), expected), 1e-9);
}

/// Three functionals: of the summed displacement, of the increments, of both.
///   J = (common) 1/2 sum_i d_i u_i^2 + (layerwise) sum_j (j + 1) |what counts of du_j|^2
template <int Dim>
struct Functionals {
  explicit Functionals(const Grid<Dim>& grid)
      : weights(test::node_field(grid, Dim, [](std::int64_t i) { return test::noise(i, 3) - 0.3; })) {}

  std::array<double, 3> values(const ProcessResult& result) const {
    double common = 0.0, layerwise = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i)
      common += 0.5 * weights[i] * result.displacement[i] * result.displacement[i];
    for (std::size_t block = 0; block < result.blocks.size(); ++block)
      for (int lane = 0; lane < result.blocks[block].lanes; ++lane)
        for (std::size_t i = 0; i < result.increments[block].unknowns(); ++i)
          layerwise += (result.blocks[block].first + lane + 1) * std::pow(result.counted(block, i, lane), 2);
    common = sum(PETSC_COMM_WORLD, common);
    layerwise = sum(PETSC_COMM_WORLD, layerwise);
    return {common, layerwise, common + layerwise};
  }
  std::array<ProcessAdjoint, 3> derivatives(const ProcessResult& result) const {
    std::array<ProcessAdjoint, 3> rows;
    for (std::size_t i = 0; i < weights.size(); ++i)
      rows[0].displacement.push_back(weights[i] * result.displacement[i]);
    rows[1].increments = result.increments;
    for (std::size_t block = 0; block < result.blocks.size(); ++block)
      for (int lane = 0; lane < result.blocks[block].lanes; ++lane)
        for (std::size_t i = 0; i < result.increments[block].unknowns(); ++i)
          rows[1].increments[block](i, lane) =
              2.0 * (result.blocks[block].first + lane + 1) * result.counted(block, i, lane);
    rows[2] = {rows[0].displacement, rows[1].increments, {}};
    return rows;
  }

  std::vector<double> weights;
};

template <int Dim>
void expect_exact_adjoint(const test::CaseSettings<Dim>& settings, int count) {
  test::ProcessCase<Dim> process(settings);
  const LayerDensities layers = process.densities(process.wavy_time(), count, 8.0);
  const LayerDensities direction = test::direction_of(process.part(), layers);
  const Functionals<Dim> functionals(process.grid());
  const auto rows = functionals.derivatives(process.simulate(layers));
  std::array<DensityDerivatives, 3> derivatives = {DensityDerivatives(count), DensityDerivatives(count),
                                                   DensityDerivatives(count)};
  const std::array<ProcessDerivatives, 3> pointers = {ProcessDerivatives{&derivatives[0]},
                                                      ProcessDerivatives{&derivatives[1]},
                                                      ProcessDerivatives{&derivatives[2]}};
  process.simulation.pull_back(layers, rows, pointers);
  EXPECT_EQ(process.simulation.adjoint_iterations().size(), static_cast<std::size_t>(count));
  for (const bool stage : {true, false}) {
    const auto values = [&](double step) {
      return functionals.values(process.simulate(test::moved(layers, step, direction, stage)));
    };
    const auto expected = test::central_differences(values, 1e-3);
    for (int row = 0; row < 3; ++row) {
      double adjoint = 0.0;
      for (int j = 0; j < count; ++j)
        adjoint += stage ? test::dot(derivatives[row].stage[j], direction.stage[j])
                         : test::dot(derivatives[row].layer[j], direction.layer[j]);
      EXPECT_NEAR(adjoint, expected[row], 1e-6 * std::abs(expected[row]))
          << row << (stage ? " stage" : " layer");
    }
  }
}

TYPED_TEST(ElasticProcessTest, AdjointAgreesWithDifferences) {
  test::CaseSettings<TypeParam::value> settings;
  settings.process.strain_penalty = 3.5;
  expect_exact_adjoint(settings, 9);  // more than are solved side by side
  settings.process.void_model = VoidModel::quiet;
  expect_exact_adjoint(settings, 2);
}

TYPED_TEST(ElasticProcessTest, AdjointOfNominalDepositionAgreesWithDifferences) {
  auto cases = test::void_models<TypeParam::value>();
  for (const auto& settings : test::clamped_cases<TypeParam::value>()) cases.push_back(settings);
  for (auto& settings : cases) {
    settings.process.deposition = DepositionModel::nominal;
    expect_exact_adjoint(settings, 3);
  }
}

}  // namespace
}  // namespace fabseq
