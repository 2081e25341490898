// SPDX-License-Identifier: MIT
/// The release from plate or clamps as a stage of the process: its adjoint against differences, and what it
/// refuses (formulation 4.3, 4.4).
#include "fabseq/base/error.h"
#include "fabseq/process/release.h"
#include "support/layered_case.h"
#include "support/process_case.h"
#include "support/table_strain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
std::vector<test::CaseSettings<Dim>> all_cases() {
  auto cases = test::void_models<Dim>();
  for (const auto& settings : test::clamped_cases<Dim>()) cases.push_back(settings);
  return cases;
}

/// J = 1/2 sum_i a_i u_i^2 + 1/2 sum_i b_i (u_i + v_i)^2 over the model's nodes.
template <int Dim>
struct Functional {
  explicit Functional(const Grid<Dim>& grid)
      : before(test::node_field(grid, Dim, [](std::int64_t i) { return test::noise(i, 3) - 0.3; })),
        after(test::node_field(grid, Dim, [](std::int64_t i) { return test::noise(i, 4) - 0.6; })) {}

  double value(const ProcessResult& result) const {
    double total = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i)
      total += 0.5 * before[i] * std::pow(result.displacement[i], 2) +
               0.5 * after[i] * std::pow(result.displacement[i] + result.release[i], 2);
    return sum(PETSC_COMM_WORLD, total);
  }
  ProcessAdjoint derivative(const ProcessResult& result) const {
    ProcessAdjoint row;
    for (std::size_t i = 0; i < before.size(); ++i) {
      row.release.push_back(after[i] * (result.displacement[i] + result.release[i]));
      row.displacement.push_back(before[i] * result.displacement[i] + row.release.back());
    }
    return row;
  }

  std::vector<double> before, after;
};

template <int Dim>
void expect_exact_adjoint(const test::CaseSettings<Dim>& settings) {
  constexpr int layers_count = 3;
  test::ProcessCase<Dim> process(settings);
  process.simulation.release_with({test::exact_solver});
  const LayerDensities layers = process.densities(process.wavy_time(), layers_count, 8.0);
  const LayerDensities direction = test::direction_of(process.part(), layers);
  std::vector<double> factors, factor_direction;
  for (int i = 0; i < layers_count * voigt_size<Dim>; ++i) {
    factors.push_back(0.5 + test::noise(i, 3));
    factor_direction.push_back(test::noise(i, 4) - 0.5);
  }
  const auto strains = test::product_strain<Dim>(test::noisy_strains(process.part()), factors);
  const auto strain_direction =
      test::product_strain<Dim>(test::noisy_strains(process.part(), 30), factor_direction);
  const Functional<Dim> functional(process.grid());
  const ProcessAdjoint row = functional.derivative(process.simulate(layers, strains));
  DensityDerivatives densities(layers_count);
  std::vector<double> d_strains;
  const ProcessDerivatives derivatives{&densities, &d_strains};
  process.simulation.pull_back(layers, {&row, 1}, {&derivatives, 1});

  for (const bool stage : {true, false}) {
    double adjoint = 0.0;
    for (int j = 0; j < layers_count; ++j)
      adjoint += stage ? test::dot(densities.stage[j], direction.stage[j])
                       : test::dot(densities.layer[j], direction.layer[j]);
    const double expected = test::central_difference(
        [&](double step) {
          return functional.value(process.simulate(test::moved(layers, step, direction, stage), strains));
        },
        1e-3);
    EXPECT_NEAR(adjoint, expected, 1e-6 * std::abs(expected)) << (stage ? "stage" : "layer");
  }
  const double expected = test::central_difference(
      [&](double step) {
        return functional.value(process.simulate(layers, test::moved(strains, step, strain_direction)));
      },
      1e-2);
  EXPECT_NEAR(test::dot(d_strains, strain_direction.values), expected, 1e-6 * std::abs(expected));
}

template <class T>
class ReleaseTest : public testing::Test {};
TYPED_TEST_SUITE(ReleaseTest, test::Dimensions);

TYPED_TEST(ReleaseTest, AdjointAgreesWithDifferences) {
  for (const auto& settings : all_cases<TypeParam::value>()) expect_exact_adjoint(settings);
}

/// On clamps, too, K_N v = -r, with all of the substrate in K_N.
TYPED_TEST(ReleaseTest, BalancesTheReactionsOfClamps) {
  constexpr int Dim = TypeParam::value;
  for (const auto& settings : test::clamped_cases<Dim>()) {
    test::ProcessCase<Dim> process(settings);
    const LayerDensities layers = process.densities(process.wavy_time(), 3, 12.0);
    (void)process.simulate(layers);
    const std::vector<double> reactions = process.simulation.reactions(layers);
    process.grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
      for (int a = 0; a < Dim; ++a) EXPECT_TRUE(process.is_held(node) || reactions[offset * Dim + a] == 0.0);
    });
    const auto v = process.whole(test::release(process, layers));
    EXPECT_GT(test::largest(v), 1e-4);
    auto forces = process.dense_system(layers, layers.count() - 1).multiply(v);
    for (double& force : forces) force = -force;
    EXPECT_LT(test::relative_difference(forces, process.whole(reactions)), 1e-9);
  }
}

/// The lane engine solves for a body that nothing holds; on several levels, on a slender one, and with a soft
/// void.
template <int Dim>
void expect_paths_agree(const Domain<Dim>& domain, const Shape& shape, VoidModel void_model) {
  const test::PartOnGrid<Dim> on_grid(domain, shape);
  const Supports<Dim> supports(on_grid.part, on_grid.description);
  ProcessSettings process;
  process.void_model = void_model;
  MaterialSettings material;
  material.inherent_strain = test::some_strain<Dim>();
  const ElasticModel<Dim> model(on_grid.part, supports, material, process);
  AssembledSolverSettings settings = test::exact_solver;
  Release<Dim> reference(model, {settings});
  settings.tolerance = 1e-9;
  settings.max_iterations = 0;  // no way back to the reference path
  Release<Dim> lanes(model, {settings, SolverPath::lanes});
  std::vector<double> derivative =
      test::node_field(on_grid.grid, Dim, [](std::int64_t i) { return test::noise(i, 3) - 0.5; });
  for (std::size_t i = 0; i < derivative.size(); ++i)
    if (on_grid.part.touched_nodes()[i / Dim] == 0) derivative[i] = 0.0;
  const auto there = [&](std::vector<double> field) {
    for (std::size_t i = 0; i < field.size(); ++i)
      if (on_grid.part.touched_nodes()[i / Dim] == 0) field[i] = 0.0;
    return test::whole_node_field<Dim>(on_grid.grid, field, Dim);
  };
  const auto expected = there(reference.adjoint(derivative));
  EXPECT_GT(test::largest(expected), 0.1);
  EXPECT_LT(test::relative_difference(there(lanes.adjoint(derivative)), expected), 1e-7);
  EXPECT_LT(test::relative_difference(there(lanes.adjoint(derivative)), expected), 1e-7);  // kept
}

TYPED_TEST(ReleaseTest, LanesAgreeWithTheReferencePath) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> elements;
  elements.fill(Dim == 2 ? 40 : 16);
  Point<Dim> size;
  size.fill(2.0);
  const Domain<Dim> domain{size, elements, 1.0};
  const Domain<Dim> odd = test::odd_domain<Dim>();
  for (const VoidModel void_model : {VoidModel::absent, VoidModel::quiet}) {
    expect_paths_agree<Dim>(domain, test::v_shape<Dim>(), void_model);
    expect_paths_agree<Dim>(odd, test::gallows<Dim>(), void_model);
  }
  std::vector<double> low(Dim, 0.0), high(Dim, 2.0);
  high[0] = 0.3;  // a wall of three elements in 3D, of six in 2D
  expect_paths_agree<Dim>(domain, test::box(low, high), VoidModel::absent);
}

/// What is kept between solves leaves no trace.
TYPED_TEST(ReleaseTest, RepeatsItselfToTheLastBit) {
  constexpr int Dim = TypeParam::value;
  const test::ProcessCase<Dim> process(test::CaseSettings<Dim>{});
  AssembledSolverSettings settings = test::exact_solver;
  settings.tolerance = 1e-9;
  Release<Dim> release(process.model, {settings, SolverPath::lanes});
  const std::vector<double> derivative =
      test::node_field(process.grid(), Dim, [](std::int64_t i) { return test::noise(i, 3); });
  const std::vector<double> first = release.adjoint(derivative);
  EXPECT_EQ(release.adjoint(derivative), first);
  release.start_cold();
  EXPECT_EQ(release.adjoint(derivative), first);
}

TYPED_TEST(ReleaseTest, PiecesThatOnlyThePlateHoldsTogetherAreRefused) {
  constexpr int Dim = TypeParam::value;
  const auto size = test::odd_domain<Dim>().size;
  std::vector<double> low(Dim, 0.0), high(size.begin(), size.end()), left(high), right(low);
  left[0] = 0.3 * size[0];
  right[0] = 0.7 * size[0];
  test::CaseSettings<Dim> settings;
  settings.shape = test::union_of({test::box(low, left), test::box(right, high)});
  test::ProcessCase<Dim> process(settings);
  EXPECT_THROW(process.simulation.release_with({test::exact_solver}), InputError);
  EXPECT_EQ(release_obstacle(process.grid(), process.supports, VoidModel::absent),
            "the part falls into 2 pieces that only their supports hold together");
  EXPECT_EQ(release_obstacle(process.grid(), process.supports, VoidModel::quiet), "");
}

}  // namespace
}  // namespace fabseq
