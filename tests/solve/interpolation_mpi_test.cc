// SPDX-License-Identifier: MIT
/// Interpolation between nested grids, as the geometric multigrid uses it.
#include "fabseq/fem/element_matrices.h"
#include "fabseq/solve/reference/assembled_system.h"
#include "fabseq/solve/reference/preconditioner.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
Domain<Dim> even_domain() {
  if constexpr (Dim == 2)
    return {{2.0, 1.0}, {32, 24}, 1.0};
  else
    return {{2.0, 0.9, 2.5}, {12, 8, 8}, 1.0};
}
template <int Dim>
Shape whole_box() {
  const auto size = even_domain<Dim>().size;
  return test::box(std::vector<double>(Dim, 0.0), {size.begin(), size.end()});
}

/// Elasticity on the whole box, held at the plate if `supported`.
template <int Dim>
struct Elasticity {
  explicit Elasticity(bool supported) : on_grid(even_domain<Dim>(), whole_box<Dim>()) {
    domain.components = Dim;
    domain.first_corners = on_grid.part.first_corners();
    on_grid.grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
      domain.fixed.insert(domain.fixed.end(), Dim, supported && on_grid.part.on_plate(node) ? 1 : 0);
    });
    numbering = std::make_shared<UnknownNumbering<Dim>>(on_grid.grid, domain);
  }

  test::PartOnGrid<Dim> on_grid;
  SystemDomain domain;
  std::shared_ptr<const UnknownNumbering<Dim>> numbering;
};

template <class T>
class InterpolationTest : public testing::Test {};
TYPED_TEST_SUITE(InterpolationTest, test::Dimensions);

TYPED_TEST(InterpolationTest, LevelsHalveTheGrid) {
  constexpr int Dim = TypeParam::value;
  const Elasticity<Dim> free(false);
  const auto levels = make_interpolations(*free.numbering, 100);
  ASSERT_GE(levels.size(), 1u);
  std::int64_t step = 1;
  for (const MatHandle& level : levels) {
    std::int64_t fine = Dim, coarse = Dim;
    for (const int elements : even_domain<Dim>().elements) {
      fine *= elements / step + 1;
      coarse *= elements / (2 * step) + 1;
    }
    PetscInt rows = 0, columns = 0;
    check(MatGetSize(level, &rows, &columns));
    EXPECT_EQ(rows, fine);
    EXPECT_EQ(columns, coarse);
    step *= 2;
  }
}

TYPED_TEST(InterpolationTest, KeepsConstants) {
  const Elasticity<TypeParam::value> free(false);
  for (const MatHandle& level : make_interpolations(*free.numbering, 100)) {
    VecHandle coarse, fine;
    check(MatCreateVecs(level, coarse.receive(), fine.receive()));
    check(VecSet(coarse, 1.0));
    check(MatMult(level, coarse, fine));
    PetscReal low = 0.0, high = 0.0;
    check(VecMin(fine, nullptr, &low));
    check(VecMax(fine, nullptr, &high));
    EXPECT_NEAR(low, 1.0, 1e-15);
    EXPECT_NEAR(high, 1.0, 1e-15);
  }
}

/// What makes it worth while: few iterations, and no more of them on several ranks.
TYPED_TEST(InterpolationTest, MultigridConvergesFast) {
  constexpr int Dim = TypeParam::value;
  const Elasticity<Dim> supported(true);
  const ElementMatrices<Dim> element(supported.on_grid.grid.spacing(), 1.0, 0.3);
  AssembledSystem<Dim> system(supported.domain, supported.numbering,
                              {ReferenceMethod::multigrid, 1e-8, 1000, "test_"});
  const std::vector<double> ones(supported.domain.first_corners.size(), 1.0);
  system.assemble({{element.stiffness(), ones}});
  const auto load =
      test::node_field(supported.on_grid.grid, Dim, [](std::int64_t i) { return test::noise(i) - 0.5; });
  std::vector<double> solution(load.size());
  const SolveReport report = system.solve(load, solution);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.iterations, 15);
}

TYPED_TEST(InterpolationTest, OddGridsHaveNone) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::block<Dim>());
  const SystemDomain domain{1, on_grid.part.first_corners(),
                            std::vector<char>(on_grid.grid.owned_nodes().count(), 0)};
  EXPECT_TRUE(make_interpolations(UnknownNumbering<Dim>(on_grid.grid, domain), 1).empty());
  const std::string count = std::to_string(on_grid.grid.domain().elements[0]);
  EXPECT_EQ(coarsening_obstacle(on_grid.grid), "an odd number of elements, " + count + ", along x");
  EXPECT_EQ(coarsening_obstacle(Elasticity<Dim>(false).on_grid.grid), "");
}

/// One rank an element along an axis: every other rank would keep no node.
TYPED_TEST(InterpolationTest, RanksWithoutACoarseNodeAreAnObstacle) {
  constexpr int Dim = TypeParam::value;
  const int ranks = size_of(PETSC_COMM_WORLD);
  if (ranks != 4) GTEST_SKIP() << "ranks: needs 4";
  Domain<Dim> domain{{}, {}, 1.0};
  domain.size.fill(1.0);
  domain.elements.fill(2);
  domain.elements[0] = 4;
  // A heavy row along x, so that the ranks line up along it.
  const Grid<Dim> grid(PETSC_COMM_WORLD, domain, [](const IndexBox<Dim>& box) {
    std::vector<double> weights(static_cast<std::size_t>(box.count()), 1e-3);
    box.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      if (std::all_of(element.begin() + 1, element.end(), [](int i) { return i == 0; }))
        weights[offset] = 1.0;
    });
    return weights;
  });
  EXPECT_EQ(coarsening_obstacle(grid), "too few elements for 4 ranks");
}

}  // namespace
}  // namespace fabseq
