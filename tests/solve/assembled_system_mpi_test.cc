// SPDX-License-Identifier: MIT
/// The reference solver's three methods against each other and against a dense matrix, on graded stiffness
/// and on parts with holes.
#include "fabseq/fem/element_matrices.h"
#include "fabseq/solve/reference/assembled_system.h"
#include "support/brute_force.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

constexpr double poisson = 0.3;
const std::vector<ReferenceMethod> all_methods = {ReferenceMethod::direct, ReferenceMethod::gamg,
                                                  ReferenceMethod::multigrid};

/// Elasticity of a part that stands on the plate: stiffness falls from 1 to 1e-9 with the height, and the
/// loads are those of inherent strains, so that displacements are everywhere of the same size.
template <int Dim>
struct Problem {
  Problem(const Domain<Dim>& size, const Shape& shape)
      : on_grid(size, shape),
        element(on_grid.grid.spacing(), size.thickness, poisson),
        expected{on_grid.grid.spacing(), size.thickness, poisson} {
    domain.components = Dim;
    domain.first_corners = on_grid.part.first_corners();
    on_grid.grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
      for (int c = 0; c < Dim; ++c) domain.fixed.push_back(is_fixed(node, c) ? 1 : 0);
    });
    stiffness = test::part_field(part(), [&](std::int64_t number) { return stiffness_of(number); });
    for_each_part_element([&](const Index<Dim>& index, double factor) {
      for (int i = 0; i < element_unknowns<Dim>; ++i)
        whole_load[dense.unknown(index, i)] += factor * load_of(index, i);
    });
    load = owned(whole_load);
  }

  const Part<Dim>& part() const { return on_grid.part; }
  const Grid<Dim>& grid() const { return on_grid.grid; }

  /// Plate nodes; every other one may slide along the plate.
  bool is_fixed(const Index<Dim>& node, int component) const {
    const bool slides = node[0] % 2 == 1;
    return node[Dim - 1] == 0 && (!slides || component == Dim - 1);
  }
  double stiffness_of(std::int64_t number) const {
    const double height = grid().all_elements().index(number)[Dim - 1];
    return std::pow(10.0, -9.0 * height / (grid().domain().elements[Dim - 1] - 1));
  }
  double load_of(const Index<Dim>& index, int i) const {
    std::vector<double> strain(voigt_size<Dim>, 0.0);
    for (int c = 0; c < Dim; ++c)
      strain[c] = -0.01 * (1.0 + test::noise(grid().all_elements().offset(index), c));
    return expected.strain_load(i, test::strain_tensor<Dim>(strain));
  }
  /// f(element, stiffness) for the part elements of all ranks.
  template <class Function>
  void for_each_part_element(Function&& f) const {
    const std::vector<double> factors = test::whole_part_field(part(), stiffness);
    grid().all_elements().for_each([&](const Index<Dim>& index, std::int64_t number) {
      if (factors[number] > 0.0) f(index, factors[number]);
    });
  }
  std::vector<double> owned(const std::vector<double>& whole) const {
    return test::node_field(grid(), Dim, [&](std::int64_t unknown) { return whole[unknown]; });
  }
  std::vector<double> dense_solution() {
    const auto matrix = expected.template matrix<element_unknowns<Dim>>(
        [&](int i, int j) { return expected.stiffness(i, j); });
    for_each_part_element([&](const Index<Dim>& index, double factor) { dense.add(index, matrix, factor); });
    dense.nodes().for_each([&](const Index<Dim>& node, std::int64_t number) {
      for (int c = 0; c < Dim; ++c)
        if (is_fixed(node, c)) dense.fix(number * Dim + c);
    });
    return dense.solve(whole_load);
  }

  AssembledSystem<Dim> system(ReferenceMethod method, double tolerance = 1e-12,
                              int max_iterations = 1000) const {
    const auto numbering = std::make_shared<UnknownNumbering<Dim>>(grid(), domain);
    AssembledSystem<Dim> result(domain, numbering, {method, tolerance, max_iterations, "test_"});
    result.assemble({{element.stiffness(), stiffness}});
    return result;
  }
  /// On all nodes of the grid.
  std::vector<double> solve(AssembledSystem<Dim>& system, const std::vector<double>& right_hand_side) const {
    std::vector<double> solution(right_hand_side.size(), 7.0);
    const SolveReport report = system.solve(right_hand_side, solution);
    EXPECT_TRUE(report.converged) << report.reason;
    EXPECT_LE(report.residual, 1e-12);
    return test::whole_node_field<Dim>(grid(), solution, Dim);
  }

  test::PartOnGrid<Dim> on_grid;
  ElementMatrices<Dim> element;
  test::BruteForceElement<Dim> expected;
  SystemDomain domain;
  std::vector<double> stiffness, load;
  test::DenseSystem<Dim> dense{on_grid.grid.domain().elements, Dim};
  std::vector<double> whole_load = std::vector<double>(dense.size(), 0.0);
};

template <class T>
class AssembledSystemTest : public testing::Test {};
TYPED_TEST_SUITE(AssembledSystemTest, test::Dimensions);

TYPED_TEST(AssembledSystemTest, AgreesWithADenseMatrixOnAPartWithHoles) {
  constexpr int Dim = TypeParam::value;
  Problem<Dim> problem(test::odd_domain<Dim>(), test::gallows<Dim>());
  const std::vector<double> expected = problem.dense_solution();
  for (const ReferenceMethod method : all_methods) {
    auto system = problem.system(method);
    EXPECT_LT(test::relative_difference(problem.solve(system, problem.load), expected), 1e-9)
        << static_cast<int>(method);
  }
}

/// Large enough for three levels of geometric multigrid; dense matrices are not.
template <int Dim>
Domain<Dim> even_domain() {
  if constexpr (Dim == 2)
    return {{2.4, 1.0}, {48, 32}, 0.25};
  else
    return {{2.0, 0.9, 2.5}, {8, 8, 8}, 1.0};
}
template <int Dim>
Shape bridge() {
  if constexpr (Dim == 2)
    return test::union_of(
        {test::box({0, 0}, {0.8, 1}), test::box({1.8, 0}, {2.4, 1}), test::box({0, 0.5}, {2.4, 1})});
  else
    return test::union_of({test::box({0, 0, 0}, {0.5, 0.9, 2.5}), test::box({1.5, 0, 0}, {2, 0.9, 2.5}),
                           test::box({0, 0.2, 1.5}, {2, 0.9, 2.5})});
}

TYPED_TEST(AssembledSystemTest, MethodsAgree) {
  constexpr int Dim = TypeParam::value;
  const Problem<Dim> problem(even_domain<Dim>(), bridge<Dim>());
  auto direct = problem.system(ReferenceMethod::direct);
  const std::vector<double> expected = problem.solve(direct, problem.load);
  EXPECT_GT(test::largest(expected), 1e-3);
  for (const ReferenceMethod method : {ReferenceMethod::gamg, ReferenceMethod::multigrid}) {
    auto system = problem.system(method);
    EXPECT_EQ(usable_method(method, UnknownNumbering<Dim>(problem.grid(), problem.domain)), method);
    EXPECT_LT(test::relative_difference(problem.solve(system, problem.load), expected), 1e-9)
        << static_cast<int>(method);
  }
}

TYPED_TEST(AssembledSystemTest, AZeroLoadGivesZero) {
  constexpr int Dim = TypeParam::value;
  const Problem<Dim> problem(test::odd_domain<Dim>(), test::gallows<Dim>());
  auto system = problem.system(ReferenceMethod::gamg);
  std::vector<double> solution(problem.load.size(), 7.0);
  const SolveReport report = system.solve(std::vector<double>(problem.load.size(), 0.0), solution);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(test::largest(solution), 0.0);
}

TYPED_TEST(AssembledSystemTest, ForcesAtSupportsAndOutsideDoNotMatter) {
  constexpr int Dim = TypeParam::value;
  const Problem<Dim> problem(test::odd_domain<Dim>(), test::gallows<Dim>());
  std::vector<double> load = problem.load;
  for (std::size_t i = 0; i < load.size(); ++i)
    if (problem.domain.fixed[i] != 0 || problem.part().touched_nodes()[i / Dim] == 0) load[i] = 1e3;
  for (const ReferenceMethod method : all_methods) {
    auto system = problem.system(method);
    const std::vector<double> plain = problem.solve(system, problem.load);
    const std::vector<double> solution = problem.solve(system, load);
    EXPECT_LT(test::relative_difference(solution, plain), 1e-11);
    const std::vector<double> here = problem.owned(solution);
    for (std::size_t i = 0; i < load.size(); ++i)
      EXPECT_EQ(load[i] == 1e3 ? here[i] : 0.0, 0.0) << static_cast<int>(method);
  }
}

TYPED_TEST(AssembledSystemTest, CanBeFilledAgain) {
  constexpr int Dim = TypeParam::value;
  Problem<Dim> problem(test::odd_domain<Dim>(), test::gallows<Dim>());
  const std::vector<double> expected = problem.dense_solution();
  for (const ReferenceMethod method : all_methods) {
    auto system = problem.system(method);
    const std::vector<double> ones(problem.stiffness.size(), 1.0), minus(problem.stiffness.size(), -1.0);
    system.assemble({{problem.element.stiffness(), ones}});
    (void)problem.solve(system, problem.load);
    // 1 - 1 + the stiffness itself: terms add up.
    system.assemble({{problem.element.stiffness(), ones},
                     {problem.element.stiffness(), minus},
                     {problem.element.stiffness(), problem.stiffness}});
    EXPECT_LT(test::relative_difference(problem.solve(system, problem.load), expected), 1e-6);
    system.assemble({{problem.element.stiffness(), problem.stiffness}});
    EXPECT_LT(test::relative_difference(problem.solve(system, problem.load), expected), 1e-9);
  }
}

TYPED_TEST(AssembledSystemTest, SaysWhenItDidNotConverge) {
  constexpr int Dim = TypeParam::value;
  const Problem<Dim> problem(even_domain<Dim>(), bridge<Dim>());
  auto system = problem.system(ReferenceMethod::gamg, 1e-12, 1);
  std::vector<double> solution(problem.load.size());
  const SolveReport report = system.solve(problem.load, solution);
  EXPECT_FALSE(report.converged);
  EXPECT_GT(report.residual, 1e-12);
  EXPECT_FALSE(report.reason.empty());
}

/// More of them than a factorization takes at a time, one of them zero.
TYPED_TEST(AssembledSystemTest, SeveralLoadsAreSolvedLikeEachByItself) {
  constexpr int Dim = TypeParam::value;
  const Problem<Dim> problem(test::odd_domain<Dim>(), test::gallows<Dim>());
  std::vector<std::vector<double>> loads(35, problem.load);
  for (std::size_t k = 0; k < loads.size(); ++k)
    for (std::size_t i = 0; i < loads[k].size(); ++i)
      loads[k][i] *= k == 3 ? 0.0 : 1.0 + test::noise(static_cast<std::int64_t>(i % 7), static_cast<int>(k));
  for (const ReferenceMethod method : all_methods) {
    auto system = problem.system(method);
    std::vector<std::vector<double>> solutions(loads.size(), std::vector<double>(problem.load.size(), 7.0));
    const std::vector<SolveReport> reports = system.solve(loads, solutions);
    ASSERT_EQ(reports.size(), loads.size());
    for (std::size_t k = 0; k < loads.size(); ++k) {
      EXPECT_TRUE(reports[k].converged) << reports[k].reason;
      EXPECT_LE(reports[k].residual, 1e-12);
      EXPECT_EQ(test::largest(solutions[k]) == 0.0, k == 3);
      if (k == 3) continue;
      EXPECT_LT(test::relative_difference(test::whole_node_field<Dim>(problem.grid(), solutions[k], Dim),
                                          problem.solve(system, loads[k])),
                1e-9);
    }
  }
}

TYPED_TEST(AssembledSystemTest, SaysWhichOfSeveralLoadsDidNotConverge) {
  constexpr int Dim = TypeParam::value;
  const Problem<Dim> problem(even_domain<Dim>(), bridge<Dim>());
  const std::vector<double> zero(problem.load.size(), 0.0);
  for (const ReferenceMethod method : {ReferenceMethod::direct, ReferenceMethod::gamg}) {
    auto system = problem.system(method, 1e-30, 2);  // beyond rounding
    const std::vector<std::vector<double>> loads = {zero, problem.load};
    std::vector<std::vector<double>> solutions = loads;
    const std::vector<SolveReport> reports = system.solve(loads, solutions);
    EXPECT_TRUE(reports[0].converged);
    EXPECT_FALSE(reports[1].converged);
    EXPECT_EQ(reports[1].iterations, 2);
    EXPECT_GT(reports[1].residual, 1e-30);
    EXPECT_FALSE(reports[1].reason.empty());
  }
}

/// One component, no support, both matrices: (K + M) 1 = M 1.
TYPED_TEST(AssembledSystemTest, ConductionWithAReactionKeepsAConstant) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::block<Dim>());
  const Grid<Dim>& grid = on_grid.grid;
  const ElementMatrices<Dim> element(grid.spacing(), grid.domain().thickness, poisson);
  const std::vector<double> conductivity = test::noise_field(on_grid.part, 1e-3, 1.0);
  const std::vector<double> ones(conductivity.size(), 1.0);
  SystemDomain domain{1, on_grid.part.first_corners(), std::vector<char>(grid.owned_nodes().count(), 0)};
  std::vector<double> ghosted(grid.ghosted_nodes().count(), 0.0), load(grid.owned_nodes().count());
  for (const int corner : domain.first_corners)
    for (const int offset : grid.corner_offsets())
      ghosted[corner + offset] += 2.0 * grid.element_volume() / corner_count<Dim>;
  grid.exchange(1).add_to_owned(ghosted, load);
  for (const ReferenceMethod method : all_methods) {
    const auto numbering = std::make_shared<UnknownNumbering<Dim>>(grid, domain);
    AssembledSystem<Dim> system(domain, numbering, {method, 1e-13, 1000, "test_"});
    system.assemble({{element.conductivity(), conductivity}, {element.mass(false), ones}});
    std::vector<double> solution(load.size());
    EXPECT_TRUE(system.solve(load, solution).converged);
    for (const double value : solution) EXPECT_NEAR(value, 2.0, 1e-10);
  }
}

}  // namespace
}  // namespace fabseq
