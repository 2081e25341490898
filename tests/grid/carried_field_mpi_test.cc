// SPDX-License-Identifier: MIT
/// A field that comes from another grid, with other ranks.
#include "fabseq/base/mpi.h"
#include "fabseq/grid/carried_field.h"
#include "fabseq/grid/grid.h"
#include "fabseq/parallel/layer_groups.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <class T>
class CarriedFieldTest : public testing::Test {};
TYPED_TEST_SUITE(CarriedFieldTest, test::Dimensions);

constexpr int components = 3;

template <int Dim>
Grid<Dim> grid_of(MPI_Comm comm, Index<Dim> elements) {
  Domain<Dim> domain;
  domain.size.fill(1.0);
  domain.elements = elements;
  return Grid<Dim>(comm, domain, nullptr);
}

/// Of an element or node of the grid that the field is on.
template <int Dim>
double value_at(const Index<Dim>& index, int component) {
  double result = component + 1.0;
  for (const int i : index) result = 100.0 * result + i;
  return result;
}

template <int Dim>
std::vector<double> field_on(const IndexBox<Dim>& box) {
  std::vector<double> result;
  box.for_each([&](const Index<Dim>& index, std::int64_t) {
    for (int c = 0; c < components; ++c) result.push_back(value_at<Dim>(index, c));
  });
  return result;
}

template <int Dim>
void expect_carried(const IndexBox<Dim>& owned, const IndexBox<Dim>& wanted, int factor) {
  const std::vector<double> found =
      carried_field<Dim>(PETSC_COMM_WORLD, owned, field_on(owned), components, wanted, factor);
  ASSERT_EQ(static_cast<std::int64_t>(found.size()), wanted.count() * components);
  wanted.for_each([&](const Index<Dim>& index, std::int64_t offset) {
    Index<Dim> parent = index;
    for (int& i : parent) i /= factor;
    for (int c = 0; c < components; ++c) EXPECT_EQ(found[offset * components + c], value_at<Dim>(parent, c));
  });
}

/// Odd numbers of elements: the last coarse ones reach beyond the fine box.
TYPED_TEST(CarriedFieldTest, EachElementTakesTheValuesOfItsParent) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> fine = uniform_index<Dim>(7), coarse = uniform_index<Dim>(4);
  fine[0] = 13;
  const Grid<Dim> from = grid_of<Dim>(PETSC_COMM_WORLD, coarse);
  coarse[0] = 7;
  const Grid<Dim> longer = grid_of<Dim>(PETSC_COMM_WORLD, coarse), to = grid_of<Dim>(PETSC_COMM_WORLD, fine);
  expect_carried<Dim>(longer.owned_elements(), to.owned_elements(), 2);
  expect_carried<Dim>(from.owned_nodes(), from.owned_nodes(), 1);
}

/// Groups of ranks have copies of the grid that the field is on; the other one is dealt out to all ranks.
TYPED_TEST(CarriedFieldTest, AnotherDecompositionIsNoMatter) {
  constexpr int Dim = TypeParam::value;
  if (size_of(PETSC_COMM_WORLD) % 2 != 0) GTEST_SKIP() << "ranks: two groups";
  const LayerGroups groups(PETSC_COMM_WORLD, 2);
  const Grid<Dim> from = grid_of<Dim>(groups.domain(), uniform_index<Dim>(6));
  const Grid<Dim> to = grid_of<Dim>(PETSC_COMM_WORLD, uniform_index<Dim>(12));
  const bool is_copy = groups.index() > 0;
  expect_carried<Dim>(is_copy ? IndexBox<Dim>{} : from.owned_elements(), to.owned_elements(), 2);
  const Grid<Dim> same = grid_of<Dim>(PETSC_COMM_WORLD, uniform_index<Dim>(6));
  expect_carried<Dim>(is_copy ? IndexBox<Dim>{} : from.owned_nodes(), same.owned_nodes(), 1);
}

}  // namespace
}  // namespace fabseq
