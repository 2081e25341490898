// SPDX-License-Identifier: MIT
#include "fabseq/sequence/refined_field.h"

#include "fabseq/base/mpi.h"

#include <array>

namespace fabseq {

namespace {

/// A field on the whole coarse grid, on every rank, with its slopes; known on the part at first.
template <int Dim>
class CoarseField {
 public:
  CoarseField(const Part<Dim>& part, std::span<const double> field)
      : box_(part.grid().all_elements()),
        entries_(static_cast<std::size_t>(box_.count())),
        known_(entries_.size(), 0) {
    std::vector<double> values(entries_.size(), 0.0), present(entries_.size(), 0.0);
    for (std::size_t e = 0; e < field.size(); ++e) {
      const auto offset = box_.offset(part.grid().owned_elements().index(part.elements()[e]));
      values[offset] = field[e];
      present[offset] = 1.0;
    }
    sum_in_place(part.grid().comm(), values);
    sum_in_place(part.grid().comm(), present);
    for (std::size_t i = 0; i < values.size(); ++i) {
      entries_[i].value = values[i];
      known_[i] = present[i] > 0.0 ? 1 : 0;
    }
    set_slopes();
  }

  bool knows(const Index<Dim>& element) const { return known_[box_.offset(element)] != 0; }
  /// At a place `away` from the centre of a known element, in its edges.
  double at(const Index<Dim>& element, const Point<Dim>& away) const {
    const Entry& entry = entries_[box_.offset(element)];
    double result = entry.value;
    for (int axis = 0; axis < Dim; ++axis)
      result += away[axis] * entry.slopes[2 * axis + (away[axis] > 0.0 ? 1 : 0)];
    return result;
  }
  /// Goes on by an element to all sides; returns whether there was anything left to reach.
  bool extend() {
    std::vector<std::pair<std::int64_t, Entry>> reached;
    box_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      if (known_[offset] != 0) return;
      if (const Entry entry = from_neighbours(element); entry.sources > 0)
        reached.emplace_back(offset, entry);
    });
    for (const auto& [offset, entry] : reached) {
      entries_[offset] = entry;
      known_[offset] = 1;
    }
    return !reached.empty();
  }

 private:
  struct Entry {
    double value = 0.0;
    std::array<double, 2 * Dim> slopes{};  ///< per element, below and above the centre, axis by axis
    int sources = 0;                       ///< elements outside the part: how many they are the mean of
  };

  /// The difference to the neighbour on each side; where there is none, that of the other side.
  void set_slopes() {
    box_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      if (known_[offset] == 0) return;
      Entry& entry = entries_[offset];
      for (int axis = 0; axis < Dim; ++axis) {
        std::array<bool, 2> there{};
        for (const int side : {0, 1}) {
          Index<Dim> neighbour = element;
          neighbour[axis] += 2 * side - 1;
          there[side] = box_.contains(neighbour) && knows(neighbour);
          if (there[side])
            entry.slopes[2 * axis + side] =
                (2 * side - 1) * (entries_[box_.offset(neighbour)].value - entry.value);
        }
        for (const int side : {0, 1})
          if (!there[side]) entry.slopes[2 * axis + side] = entry.slopes[2 * axis + 1 - side];
      }
    });
  }

  /// The mean of what the known neighbours go on to: of those with a common face, or else edge, or corner.
  Entry from_neighbours(const Index<Dim>& element) const {
    IndexBox<Dim> around;
    around.size.fill(3);
    for (int apart = 1; apart <= Dim; ++apart) {
      Entry sum;
      around.for_each([&](const Index<Dim>& step, std::int64_t) {
        Index<Dim> neighbour = element;
        Point<Dim> away{};
        int steps = 0;
        for (int axis = 0; axis < Dim; ++axis) {
          neighbour[axis] += step[axis] - 1;
          away[axis] = 1.0 - step[axis];
          steps += step[axis] != 1 ? 1 : 0;
        }
        if (steps != apart || !box_.contains(neighbour) || !knows(neighbour)) return;
        const Entry& from = entries_[box_.offset(neighbour)];
        sum.value += at(neighbour, away);
        for (std::size_t k = 0; k < sum.slopes.size(); ++k) sum.slopes[k] += from.slopes[k];
        ++sum.sources;
      });
      if (sum.sources == 0) continue;
      sum.value /= sum.sources;
      for (double& slope : sum.slopes) slope /= sum.sources;
      return sum;
    }
    return {};
  }

  IndexBox<Dim> box_;
  std::vector<Entry> entries_;
  std::vector<char> known_;
};

}  // namespace

template <int Dim>
std::vector<double> refined_field(const Part<Dim>& part, std::span<const double> field,
                                  const Part<Dim>& fine) {
  CoarseField<Dim> coarse(part, field);
  const IndexBox<Dim>& owned = fine.grid().owned_elements();
  const auto parent = [&](std::size_t e) {
    Index<Dim> element = owned.index(fine.elements()[e]);
    for (int& index : element) index /= 2;
    return element;
  };
  for (std::size_t e = 0; e < fine.elements().size(); ++e)
    while (!coarse.knows(parent(e)) && coarse.extend()) continue;
  std::vector<double> result;
  for (std::size_t e = 0; e < fine.elements().size(); ++e) {
    const Index<Dim> element = owned.index(fine.elements()[e]);
    Point<Dim> away;
    for (int axis = 0; axis < Dim; ++axis) away[axis] = element[axis] % 2 == 0 ? -0.25 : 0.25;
    result.push_back(coarse.at(parent(e), away));
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(refined_field);

}  // namespace fabseq
