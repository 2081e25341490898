// SPDX-License-Identifier: MIT
/// Residual stress, the plate's reactions and the release (formulation 4.3).
#include "fabseq/process/residual_stress.h"
#include "support/process_case.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

/// All moments of nodal forces [node][component] about a point, and the forces themselves, relative to the
/// sum of their sizes. Also the components of a mean rigid motion, where `forces` are displacements.
template <int Dim>
std::vector<double> resultants(const Grid<Dim>& grid, const std::vector<double>& whole_forces,
                               const Point<Dim>& about) {
  std::vector<double> result;
  const auto total = [&](auto&& term) {
    double value = 0.0;
    grid.all_nodes().for_each([&](const Index<Dim>& node, std::int64_t n) {
      const Point<Dim> x = grid.node_position(node);
      value += term(&whole_forces[n * Dim], x);
    });
    return value;
  };
  for (int a = 0; a < Dim; ++a) {
    result.push_back(total([&](const double* f, const Point<Dim>&) { return f[a]; }));
    for (int b = 0; b < a; ++b)
      result.push_back(total([&](const double* f, const Point<Dim>& x) {
        return (x[a] - about[a]) * f[b] - (x[b] - about[b]) * f[a];
      }));
  }
  return result;
}

template <class T>
class ResidualStressTest : public testing::Test {};
TYPED_TEST_SUITE(ResidualStressTest, test::Dimensions);

TYPED_TEST(ResidualStressTest, AgreesWithTheTensorFormula) {
  constexpr int Dim = TypeParam::value;
  for (auto settings : test::void_models<Dim>()) {
    settings.material.young = 7.0;
    test::ProcessCase<Dim> process(settings);
    const Grid<Dim>& grid = process.grid();
    const LayerDensities layers = process.densities(process.wavy_time(), 3, 12.0);
    (void)process.simulate(layers);
    const auto stress =
        test::whole_element_field<Dim>(grid, residual_stress(process.simulation, layers), voigt_size<Dim>);

    const auto element = process.brute_force_element();
    const auto inherent = element.stress(test::strain_tensor<Dim>(settings.material.inherent_strain));
    const auto increments = process.dense_increments(layers);
    std::vector<double> expected(stress.size(), 0.0);
    for (int j = 0; j < layers.count(); ++j) {
      const test::DenseSystem<Dim> numbers(grid.domain().elements, Dim);
      const auto [stiffness, load] = process.element_factors(layers, j);
      grid.all_elements().for_each([&](const Index<Dim>& index, std::int64_t e) {
        std::array<double, element_unknowns<Dim>> u{};
        for (int i = 0; i < element_unknowns<Dim>; ++i) u[i] = increments[j][numbers.unknown(index, i)];
        auto tensor = element.stress(element.center_strain(u));
        for (int a = 0; a < Dim; ++a)
          for (int b = 0; b < Dim; ++b) tensor[a][b] = stiffness[e] * tensor[a][b] - load[e] * inherent[a][b];
        const auto voigt = test::stress_voigt<Dim>(tensor);
        for (int c = 0; c < voigt_size<Dim>; ++c) expected[e * voigt_size<Dim> + c] += 7.0 * voigt[c];
      });
    }
    EXPECT_LT(test::relative_difference(stress, expected), 1e-7);
  }
}

TYPED_TEST(ResidualStressTest, ReactionsBalance) {
  constexpr int Dim = TypeParam::value;
  for (const auto& settings : test::void_models<Dim>()) {
    test::ProcessCase<Dim> process(settings);
    const LayerDensities layers = process.densities(process.wavy_time(), 3, 12.0);
    (void)process.simulate(layers);
    const auto reactions = process.simulation.reactions(layers);
    process.grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
      for (int a = 0; a < Dim; ++a)
        EXPECT_TRUE(process.part().on_plate(node) || reactions[offset * Dim + a] == 0.0);
    });
    const auto whole = process.whole(reactions);
    EXPECT_GT(test::largest(whole), 1e-4);
    for (const double resultant : resultants<Dim>(process.grid(), whole, Point<Dim>{}))
      EXPECT_NEAR(resultant, 0.0, 1e-9 * test::largest(whole));
  }
}

/// A strain along the normal of planar layers leaves no stress (see the test of the process simulation).
TYPED_TEST(ResidualStressTest, NothingIsLeftWithoutConstraint) {
  constexpr int Dim = TypeParam::value;
  test::CaseSettings<Dim> settings;
  settings.material.inherent_strain.assign(voigt_size<Dim>, 0.0);
  settings.material.inherent_strain[Dim - 1] = -0.01;
  test::ProcessCase<Dim> process(settings);
  const LayerDensities layers = process.densities(process.planar_time(), 5, 10.0, true);
  (void)process.simulate(layers);
  EXPECT_LT(test::largest(residual_stress(process.simulation, layers)), 1e-10);
  EXPECT_LT(test::largest(process.simulation.reactions(layers)), 1e-10);
  EXPECT_LT(test::largest(test::release(process, layers)), 1e-9);
}

/// Mean position of the part's plate nodes.
template <int Dim>
Point<Dim> plate_center(const test::ProcessCase<Dim>& process) {
  std::vector<double> sums(Dim + 1, 0.0);
  process.grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    if (!process.part().on_plate(node) || process.part().touched_nodes()[offset] == 0) return;
    for (int a = 0; a < Dim; ++a) sums[a] += process.grid().node_position(node)[a];
    sums[Dim] += 1.0;
  });
  sum_in_place(PETSC_COMM_WORLD, sums);
  Point<Dim> center{};
  for (int a = 0; a < Dim; ++a) center[a] = sums[a] / sums[Dim];
  return center;
}

/// One layer with a uniform isotropic strain: let go, the part contracts as if it had never been held, about
/// the centre of the plate's nodes.
TYPED_TEST(ResidualStressTest, ReleaseGivesTheFreeContraction) {
  constexpr int Dim = TypeParam::value;
  const double strain = -0.013;
  for (const BuildPlate plate : {BuildPlate{Dim - 1, false}, BuildPlate{0, false}})
    for (const Shape& shape : {test::block<Dim>(), test::gallows<Dim>()}) {
      test::CaseSettings<Dim> settings;
      settings.shape = shape;
      settings.plate = plate;
      settings.material.inherent_strain = test::isotropic_strain<Dim>(strain);
      test::ProcessCase<Dim> process(settings);
      const LayerDensities layers = process.densities(process.planar_time(), 1, 10.0);
      const auto u = process.simulate(layers).displacement;
      const auto v = test::release(process, layers);
      const Point<Dim> center = plate_center(process);
      process.grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
        const Point<Dim> x = process.grid().node_position(node);
        const bool there = process.part().touched_nodes()[offset] != 0;
        for (int a = 0; a < Dim; ++a)
          EXPECT_NEAR(u[offset * Dim + a] + v[offset * Dim + a], there ? strain * (x[a] - center[a]) : 0.0,
                      1e-11);
      });
    }
}

/// The increment balances the reactions, K_N v = -r, and moves the plate's nodes by no mean rigid motion.
TYPED_TEST(ResidualStressTest, ReleaseBalancesTheReactions) {
  constexpr int Dim = TypeParam::value;
  for (const auto& settings : test::void_models<Dim>()) {
    test::ProcessCase<Dim> process(settings);
    const LayerDensities layers = process.densities(process.wavy_time(), 3, 12.0);
    (void)process.simulate(layers);
    const auto reactions = process.whole(process.simulation.reactions(layers));
    auto v = process.whole(test::release(process, layers));
    EXPECT_GT(test::largest(v), 1e-4);
    auto forces = process.dense_system(layers, layers.count() - 1).multiply(v);
    for (double& force : forces) force = -force;
    EXPECT_LT(test::relative_difference(forces, reactions), 1e-9);

    // The plate's nodes are the part's, also with the void quiet: those of the void are as soft as the void.
    const auto touched = test::whole_node_field<Dim>(
        process.grid(),
        std::vector<double>(process.part().touched_nodes().begin(), process.part().touched_nodes().end()));
    process.grid().all_nodes().for_each([&](const Index<Dim>& node, std::int64_t n) {
      const bool counts = process.part().on_plate(node) && touched[n] != 0.0;
      for (int a = 0; !counts && a < Dim; ++a) v[n * Dim + a] = 0.0;
    });
    for (const double motion : resultants<Dim>(process.grid(), v, plate_center(process)))
      EXPECT_NEAR(motion, 0.0, 1e-10 * std::max(1e-3, test::largest(v)));
  }
}

}  // namespace
}  // namespace fabseq
