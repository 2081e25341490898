// SPDX-License-Identifier: MIT
/// Values that travel between the ranks of a level and those of the next.
#include "ranks/level_gather.h"
#include "support/masked_grid.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace fabseq {
namespace {

/// Ranges that begin at odd elements, and a grid that is too small for some ranks.
template <int Dim>
std::vector<Index<Dim>> sizes() {
  if constexpr (Dim == 2)
    return {{21, 13}, {40, 5}};
  else
    return {{9, 7, 10}, {2, 3, 25}};
}

/// Stages of all ranks, and who holds what they lie in, as for a fine level with `active` elements.
template <int Dim>
struct Stages {
  Stages(const Index<Dim>& size, const test::Mask<Dim>& mask, std::int64_t active)
      : masked(PETSC_COMM_WORLD, size, mask, {Dim - 1, false}),
        fine(LevelShares<Dim>::finest(masked.grid.decomposition())) {
    factors.fill(2);
    coarse = fine.coarsened(factors, active);
    const auto parents = fine.elements_of(rank_of(PETSC_COMM_WORLD)).coarsened(factors);
    std::vector<char> touched(static_cast<std::size_t>(parents.count()), 0);
    masked.whole.for_each_active([&](Index<Dim> element, std::int64_t) {
      if (!masked.grid.owned_elements().contains(element)) return;
      for (int& i : element) i /= 2;
      touched[parents.offset(element)] = 1;
    });
    stage = LaneMesh<Dim>(parents, touched);
    gather = LevelGather<Dim>(PETSC_COMM_WORLD, stage, coarse);
    for (int axis = 0; axis < Dim; ++axis) {
      elements.size[axis] = (size[axis] + 1) / 2;
      nodes.size[axis] = elements.size[axis] + 1;
    }
  }

  test::MaskedGrid<Dim> masked;
  LevelShares<Dim> fine, coarse;
  Index<Dim> factors{};
  LaneMesh<Dim> stage;
  LevelGather<Dim> gather;
  IndexBox<Dim> elements, nodes;  ///< of the whole coarse level
};

template <int Dim, class Function>
void for_each_case(Function&& f) {
  for (const auto& size : sizes<Dim>())
    for (const auto& mask : test::masks<Dim>())
      for (const std::int64_t active : {std::int64_t{1}, std::int64_t{3200}, std::int64_t{1} << 40}) {
        SCOPED_TRACE(mask.name + " " + to_text<Dim>(size) + " " + std::to_string(active));
        Stages<Dim> stages(size, mask, active);
        f(stages);
      }
}

/// f(number in the mesh, place in the box) of the mesh's elements.
template <int Dim, class Function>
void for_each_element(const LaneMesh<Dim>& mesh, const IndexBox<Dim>& all, Function&& f) {
  mesh.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    if (mesh.element_number(element) >= 0) f(mesh.element_number(element), all.offset(element));
  });
}

template <class T>
class LevelGatherTest : public testing::Test {};
TYPED_TEST_SUITE(LevelGatherTest, test::Dimensions);

/// What all stages have of a node, its holders have together; an element has one holder.
TYPED_TEST(LevelGatherTest, SumsAreThoseOfTheStages) {
  for_each_case<TypeParam::value>([](auto& s) {
    const int rank = rank_of(PETSC_COMM_WORLD);
    const auto value = [&](std::int64_t place, int entry) { return place % 17 + 3.0 * entry + 0.5 * rank; };
    std::vector<double> expected(s.nodes.count() * 2, 0.0), found = expected;
    std::vector<double> parts(s.stage.nodes() * 2), sums(s.gather.mesh().nodes() * 2, 0.0);
    test::for_each_node(s.stage, [&](const auto& node, std::int64_t number) {
      for (int entry = 0; entry < 2; ++entry)
        expected[s.nodes.offset(node) * 2 + entry] += parts[number * 2 + entry] =
            value(s.nodes.offset(node), entry);
    });
    s.gather.add_nodes(parts.data(), sums.data(), 2);
    test::for_each_node(s.gather.mesh(), [&](const auto& node, std::int64_t number) {
      for (int entry = 0; entry < 2; ++entry)
        found[s.nodes.offset(node) * 2 + entry] += sums[number * 2 + entry];
    });
    sum_in_place(PETSC_COMM_WORLD, expected);
    sum_in_place(PETSC_COMM_WORLD, found);
    EXPECT_EQ(found, expected);

    std::vector<double> of_elements(s.elements.count(), 0.0), at_holders = of_elements;
    std::vector<float> element_parts(s.stage.elements()), element_sums(s.gather.mesh().elements(), 0.0F);
    std::vector<std::int64_t> holders(s.elements.count(), 0);
    for_each_element(s.stage, s.elements, [&](int number, std::int64_t place) {
      element_parts[number] = static_cast<float>(value(place, 1));
      of_elements[place] += value(place, 1);
    });
    s.gather.add_elements(element_parts.data(), element_sums.data(), 1);
    for_each_element(s.gather.mesh(), s.elements, [&](int number, std::int64_t place) {
      at_holders[place] += element_sums[number];
      ++holders[place];
    });
    sum_in_place(PETSC_COMM_WORLD, of_elements);
    sum_in_place(PETSC_COMM_WORLD, at_holders);
    sum_in_place(PETSC_COMM_WORLD, holders);
    EXPECT_EQ(at_holders, of_elements);
    for (std::size_t i = 0; i < holders.size(); ++i) EXPECT_EQ(holders[i], of_elements[i] > 0.0 ? 1 : 0);
  });
}

TYPED_TEST(LevelGatherTest, StagesGetWhatHoldersHave) {
  for_each_case<TypeParam::value>([](auto& s) {
    std::vector<double> values(s.gather.mesh().nodes() * 3);
    std::vector<double> fetched(s.stage.nodes() * 3, std::numeric_limits<double>::quiet_NaN());
    test::for_each_node(s.gather.mesh(), [&](const auto& node, std::int64_t number) {
      for (int entry = 0; entry < 3; ++entry)
        values[number * 3 + entry] = 10.0 * s.nodes.offset(node) + entry;
    });
    s.gather.fetch_nodes(values.data(), fetched.data(), 3);
    test::for_each_node(s.stage, [&](const auto& node, std::int64_t number) {
      for (int entry = 0; entry < 3; ++entry)
        EXPECT_EQ(fetched[number * 3 + entry], 10.0 * s.nodes.offset(node) + entry);
    });
  });
}

}  // namespace
}  // namespace fabseq
