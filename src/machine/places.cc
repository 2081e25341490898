// SPDX-License-Identifier: MIT
#include "fabseq/machine/places.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/components.h"
#include "machine/place_form.h"
#include "machine/place_measures.h"
#include "machine/resting.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

namespace {

/// Adds the volume of what only rests on each place. Collective.
template <int Dim>
void add_what_begins(const Part<Dim>& part, std::span<const int> carrying, std::vector<Place>& places) {
  std::vector<double> densities(places.size(), 0.0);
  for (std::size_t e = 0; e < carrying.size(); ++e)
    if (carrying[e] >= 0) densities[carrying[e]] += part.part_density()[e];
  sum_in_place(part.grid().comm(), std::span<double>(densities));
  for (std::size_t p = 0; p < places.size(); ++p)
    places[p].begins = densities[p] * part.grid().element_volume();
}

bool more_begins(const Place& a, const Place& b) { return a.begins > b.begins; }

}  // namespace

template <int Dim>
Places find_places(const Part<Dim>& part, Fault fault, std::span<const double> marks,
                   std::span<const double> figures, const CheckedLayers& layers) {
  const Components components = find_components<Dim>(part.grid(), part.expand(marks), Contact::corner);
  if (components.count == 0) return {};
  std::vector<int> place_of;
  for (const int element : part.elements()) place_of.push_back(components.of_element[element]);
  std::vector<Place> all =
      measured_places<Dim>(part, fault, components.count, place_of, marks, figures, layers);
  std::vector<int> carrying;
  if (fault == Fault::hanging) {
    const Feet<Dim> feet(part, layers.direction, layers.layer_index, layers.bead_width);
    carrying = places_that_carry<Dim>(part, feet, layers.layer_index, place_of);
    add_what_begins<Dim>(part, carrying, all);
  }
  Places result;
  result.in_all = components.count;
  for (const Place& place : all) result.begins += place.begins;
  std::vector<int> numbers(all.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  std::stable_sort(numbers.begin(), numbers.end(), [&](int a, int b) { return more_begins(all[a], all[b]); });
  numbers.resize(std::min(numbers.size(), most_places_told));
  for (const int number : numbers) result.largest.push_back(std::move(all[number]));
  if (fault == Fault::hanging)
    tell_forms<Dim>(part, result.largest, numbers, place_of, carrying, layers.layer_index);
  return result;
}

bool Bead::is_larger_than(const Place& place) const {
  const auto within_layer = static_cast<int>(place.extent.size()) - 1;
  return place.across() < width && place.begins < std::pow(width, within_layer) * height;
}

Places merged(std::vector<Places> kinds) {
  Places result;
  for (Places& kind : kinds) {
    result.in_all += kind.in_all;
    result.begins += kind.begins;
    for (Place& place : kind.largest) result.largest.push_back(std::move(place));
  }
  std::stable_sort(result.largest.begin(), result.largest.end(), more_begins);
  if (result.largest.size() > most_places_told) result.largest.resize(most_places_told);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(find_places);

}  // namespace fabseq
