// SPDX-License-Identifier: MIT
/// Places at which checks fail (docs/formulation.md 13.4), against brute force, on 1 to 4 ranks.
#include "fabseq/machine/footing.h"
#include "fabseq/machine/hanging.h"
#include "fabseq/machine/places.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

namespace fabseq {
namespace {

using test::box;
using test::PartOnGrid;

/// The height of each part element, in layers of one element, from 1.
std::vector<double> planar_layers(const Part<3>& part) {
  std::vector<double> result;
  for (const int element : part.elements())
    result.push_back(part.grid().owned_elements().index(element)[2] + 1.0);
  return result;
}

Places hanging_places(const Part<3>& part, const std::vector<double>& layer) {
  const std::vector<double> marks = hanging_elements<3>(part, {}, layer, 0.0);
  return find_places<3>(part, Fault::hanging, marks, marks, {{}, layer, 0.0});
}

TEST(PlacesTest, ABarBesideItsColumnIsAnOverhang) {
  const PartOnGrid<3> on_grid({{8.0, 2.0, 6.0}, {8, 2, 6}, 1.0},
                              test::union_of({box({0, 0, 0}, {2, 2, 4}), box({0, 0, 4}, {8, 2, 6})}));
  const Places found = hanging_places(on_grid.part, planar_layers(on_grid.part));
  ASSERT_EQ(found.in_all, 1);
  const Place& place = found.largest[0];
  EXPECT_EQ(place.form, PlaceForm::overhang);
  EXPECT_EQ(place.elements, 10);
  EXPECT_EQ(place.layer, 5);
  EXPECT_DOUBLE_EQ(place.volume, 10.0);
  // Of the bar's upper layer, the element beside the column leans on what the column carries.
  EXPECT_DOUBLE_EQ(place.begins, 10.0 + 8.0);
  EXPECT_DOUBLE_EQ(found.begins, 18.0);
  EXPECT_EQ(place.lower, (std::vector<double>{3, 0, 4}));
  EXPECT_EQ(place.upper, (std::vector<double>{8, 2, 5}));
  EXPECT_EQ(place.centre, (std::vector<double>{5.5, 1, 4.5}));
  EXPECT_EQ(place.extent, (std::vector<double>{5, 2, 1}));
}

TEST(PlacesTest, WhatClosesASlotIsARoofAndAStartInTheAirAnIsland) {
  const PartOnGrid<3> on_grid(
      {{9.0, 3.0, 6.0}, {9, 3, 6}, 1.0},
      test::union_of({box({0, 0, 0}, {2, 3, 5}), box({7, 0, 0}, {9, 3, 5}), box({0, 0, 3}, {9, 3, 5})}));
  const Part<3>& part = on_grid.part;
  std::vector<double> layer = planar_layers(part);
  const Places planar = hanging_places(part, layer);
  ASSERT_EQ(planar.in_all, 1);
  EXPECT_EQ(planar.largest[0].form, PlaceForm::roof);
  EXPECT_EQ(planar.largest[0].elements, 3 * 3);  // an element at either end leans out
  // The middle of the bridge is built first of all that is not below.
  const PartOnGrid<3> table({{5.0, 3.0, 4.0}, {5, 3, 4}, 1.0},
                            test::union_of({box({0, 0, 0}, {1, 3, 4}), box({0, 0, 2}, {5, 3, 4})}));
  std::vector<double> times;
  for (const int element : table.part.elements()) {
    const Index<3> index = table.part.grid().owned_elements().index(element);
    times.push_back(index == Index<3>{4, 1, 2} ? 1.0 : index[0] == 0 ? 1.0 : 6.0 - index[0]);
  }
  const Places found = hanging_places(table.part, times);
  ASSERT_GE(found.in_all, 1);
  EXPECT_EQ(std::count_if(found.largest.begin(), found.largest.end(),
                          [](const Place& place) { return place.form == PlaceForm::island; }),
            1);
}

/// The layers, directions and marks of a part, the same on any ranks.
template <int Dim>
struct RandomLayers {
  std::vector<double> layer, direction, marks, figures;

  explicit RandomLayers(const Part<Dim>& part) {
    for (const int element : part.elements()) {
      const Index<Dim> index = part.grid().owned_elements().index(element);
      std::mt19937 random(static_cast<unsigned>(part.grid().all_elements().offset(index)) + 7);
      layer.push_back(1.0 + static_cast<double>(random() % 6));
      Point<Dim> axis{};
      for (double& component : axis) component = std::uniform_real_distribution<>(-1.0, 1.0)(random);
      for (const double component : axis) direction.push_back(component / std::sqrt(dot(axis, axis)));
      marks.push_back(random() % 12 == 0 ? 1.0 + static_cast<double>(random() % 8) : 0.0);
      figures.push_back(100.0 - marks.back());
    }
  }
};

/// What a place must be, by flooding the whole grid.
struct Expected {
  std::int64_t elements = 0;
  double volume = 0.0, worst = 0.0, mark = 0.0;
  int layer = 1000;

  auto key() const { return std::tuple(elements, std::llround(1e6 * volume), worst, layer); }
};

template <int Dim>
std::vector<Index<Dim>> flood(const IndexBox<Dim>& all, const std::vector<double>& marks,
                              std::set<std::int64_t>& seen, const Index<Dim>& seed) {
  std::vector<Index<Dim>> result = {seed};
  seen.insert(all.offset(seed));
  for (std::size_t i = 0; i < result.size(); ++i)
    ringed<Dim>({result[i], uniform_index<Dim>(1)}).for_each([&](const Index<Dim>& next, std::int64_t) {
      if (all.contains(next) && marks[all.offset(next)] > 0.0 && seen.insert(all.offset(next)).second)
        result.push_back(next);
    });
  return result;
}

template <class Dimension>
class PlacesOnAnyRanksTest : public testing::Test {};
TYPED_TEST_SUITE(PlacesOnAnyRanksTest, test::Dimensions);

TYPED_TEST(PlacesOnAnyRanksTest, AreWhatFloodingFinds) {
  constexpr int Dim = TypeParam::value;
  const PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const Part<Dim>& part = on_grid.part;
  const Grid<Dim>& grid = part.grid();
  const RandomLayers<Dim> random(part);
  const auto whole = [&](const std::vector<double>& field) {
    return test::whole_element_field(grid, part.expand(field));
  };
  const std::vector<double> marks = whole(random.marks), layer = whole(random.layer),
                            figures = whole(random.figures), density = whole(part.part_density());
  std::set<std::int64_t> seen;
  std::vector<Expected> expected;
  const IndexBox<Dim> all = grid.all_elements();
  all.for_each([&](const Index<Dim>& seed, std::int64_t number) {
    if (marks[number] <= 0.0 || seen.count(number) > 0) return;
    Expected& place = expected.emplace_back();
    for (const Index<Dim>& element : flood<Dim>(all, marks, seen, seed)) {
      const std::int64_t offset = all.offset(element);
      ++place.elements;
      place.volume += density[offset] * grid.element_volume();
      place.layer = std::min(place.layer, static_cast<int>(layer[offset]));
      if (marks[offset] > place.mark) {
        place.mark = marks[offset];
        place.worst = figures[offset];
      }
    }
  });
  const Places found = find_places<Dim>(part, Fault::tilt, random.marks, random.figures,
                                        {random.direction, random.layer, 0.0});
  ASSERT_EQ(found.in_all, static_cast<std::int64_t>(expected.size()));
  ASSERT_GT(expected.size(), 1U);
  ASSERT_LE(expected.size(), most_places_told);
  std::multiset<decltype(Expected().key())> keys, found_keys;
  for (const Expected& place : expected) keys.insert(place.key());
  for (const Place& place : found.largest) {
    found_keys.insert(Expected{place.elements, place.volume, place.worst, 0.0, place.layer}.key());
    EXPECT_EQ(place.begins, place.volume);
    for (int axis = 0; axis < Dim; ++axis) EXPECT_LT(place.lower[axis], place.upper[axis]);
    EXPECT_GE(place.extent[0], place.across());
  }
  EXPECT_EQ(keys, found_keys);
  EXPECT_TRUE(std::is_sorted(found.largest.begin(), found.largest.end(),
                             [](const Place& a, const Place& b) { return a.begins > b.begins; }));
}

/// What nothing carries that the plate carries: the definition, on whole fields, until nothing changes.
TYPED_TEST(PlacesOnAnyRanksTest, CarryWhatNothingElseCarries) {
  constexpr int Dim = TypeParam::value;
  const PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const Part<Dim>& part = on_grid.part;
  const Grid<Dim>& grid = part.grid();
  const RandomLayers<Dim> random(part);
  const Footing<Dim> footing(grid, 0.0);
  const IndexBox<Dim> all = grid.all_elements();
  const std::vector<double> layer = test::whole_element_field(grid, part.expand(random.layer));
  std::array<std::vector<double>, Dim> direction;
  for (int i = 0; i < Dim; ++i) {
    std::vector<double> component;
    for (std::size_t e = 0; e < random.layer.size(); ++e) component.push_back(random.direction[e * Dim + i]);
    direction[i] = test::whole_element_field(grid, part.expand(component));
  }
  std::set<std::int64_t> carried;
  std::map<std::int64_t, std::vector<std::int64_t>> feet;  // of each element; -1: the plate
  all.for_each([&](const Index<Dim>& element, std::int64_t number) {
    if (layer[number] == 0.0) return;
    auto& own = feet[number];
    Point<Dim> axis;
    for (int i = 0; i < Dim; ++i) axis[i] = direction[i][number];
    for (const Index<Dim>& step : footing.steps()) {
      Index<Dim> below = element;
      for (int i = 0; i < Dim; ++i) below[i] += step[i];
      if (!footing.holds(step, axis.data())) continue;
      if (below[Dim - 1] < 0)
        own.push_back(-1);
      else if (all.contains(below) && layer[all.offset(below)] > 0.0 &&
               layer[all.offset(below)] <= layer[number])
        own.push_back(all.offset(below));
    }
  });
  for (bool again = true; again;) {
    again = false;
    for (const auto& [number, own] : feet)
      if (std::any_of(own.begin(), own.end(), [&](auto foot) { return foot < 0 || carried.count(foot) > 0; }))
        again |= carried.insert(number).second;
  }
  std::set<std::int64_t> on_places;
  for (const auto& [number, own] : feet)
    if (own.empty()) on_places.insert(number);
  const std::size_t hanging = on_places.size();
  for (bool again = true; again;) {
    again = false;
    for (const auto& [number, own] : feet)
      if (carried.count(number) == 0 &&
          std::any_of(own.begin(), own.end(), [&](auto foot) { return on_places.count(foot) > 0; }))
        again |= on_places.insert(number).second;
  }
  const std::vector<double> marks = hanging_elements<Dim>(part, random.direction, random.layer, 0.0);
  const Places found =
      find_places<Dim>(part, Fault::hanging, marks, marks, {random.direction, random.layer, 0.0});
  const std::vector<double> density = test::whole_element_field(grid, part.expand(part.part_density()));
  double begins = 0.0;
  for (const std::int64_t number : on_places) begins += density[number] * grid.element_volume();
  EXPECT_GT(on_places.size(), hanging) << "nothing rests on what hangs";
  EXPECT_NEAR(found.begins, begins, 1e-9 * begins);
}

}  // namespace
}  // namespace fabseq
