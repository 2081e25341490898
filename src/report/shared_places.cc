// SPDX-License-Identifier: MIT
#include "report/shared_places.h"

#include <algorithm>

namespace fabseq {

namespace {

bool meet(const Place& a, const Place& b, double margin) {
  for (std::size_t axis = 0; axis < a.lower.size(); ++axis)
    if (a.lower[axis] - margin > b.upper[axis] + margin || b.lower[axis] - margin > a.upper[axis] + margin)
      return false;
  return true;
}

bool has_roof_at(const SequenceNumbers& sequence, const Place& roof, double margin) {
  if (!sequence.found.places) return false;
  const auto& places = sequence.found.places->largest;
  return std::any_of(places.begin(), places.end(), [&](const Place& place) {
    return place.form == PlaceForm::roof && meet(place, roof, margin);
  });
}

}  // namespace

std::vector<bool> shared_roofs(const FaultyPlaces& of, const std::vector<const SequenceNumbers*>& sequences) {
  std::vector<bool> result;
  for (const Place& place : of.largest)
    result.push_back(place.form == PlaceForm::roof && sequences.size() > 1 &&
                     std::all_of(sequences.begin(), sequences.end(), [&](const SequenceNumbers* sequence) {
                       return has_roof_at(*sequence, place, 0.5 * of.bead.width);
                     }));
  return result;
}

BuildClass class_beside(const SequenceNumbers& of, const std::vector<const SequenceNumbers*>& sequences,
                        const ToolSettings& tool) {
  if (!of.found.places) return of.verdict->build_class;
  return class_without(*of.found.places, shared_roofs(*of.found.places, sequences), tool);
}

}  // namespace fabseq
