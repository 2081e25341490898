// SPDX-License-Identifier: MIT
#include "fabseq/sequence/refined_field.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/box_gather.h"

#include <algorithm>
#include <array>
#include <utility>

namespace fabseq {

namespace {

/// A field on this rank's elements of the coarse grid and on those around them, with its slopes; known on the
/// part at first. Construction and extend() are collective.
template <int Dim>
class CoarseField {
 public:
  /// The value at the centre of an element, and how the field goes on from there.
  struct Entry {
    double value = 0.0;
    std::array<double, 2 * Dim> slopes{};  ///< per element, below and above the centre, axis by axis
    bool known = false;

    /// Returns the value at a place `away` from the centre, in the element's edges.
    double at(const Point<Dim>& away) const {
      double result = value;
      for (int axis = 0; axis < Dim; ++axis)
        result += away[axis] * slopes[2 * axis + (away[axis] > 0.0 ? 1 : 0)];
      return result;
    }
  };

  CoarseField(const Part<Dim>& part, std::span<const double> field, BeyondCentres beyond)
      : comm_(part.grid().comm()),
        beyond_(beyond),
        owned_(part.grid().owned_elements()),
        ring_(comm_, owned_, ringed(owned_)),
        entries_(static_cast<std::size_t>(owned_.count())) {
    for (std::size_t e = 0; e < field.size(); ++e) {
      entries_[part.elements()[e]].value = field[e];
      entries_[part.elements()[e]].known = true;
    }
    exchange();
    owned_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      if (entries_[offset].known) set_slopes(element, entries_[offset]);
    });
    exchange();
  }

  /// Returns the entry of an owned element.
  const Entry& operator[](const Index<Dim>& element) const { return entries_[owned_.offset(element)]; }
  /// Goes on by an element to all sides; returns whether there was anything left to reach, on any rank.
  bool extend() {
    std::vector<std::pair<std::int64_t, Entry>> reached;
    owned_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      if (entries_[offset].known) return;
      if (const Entry entry = from_neighbours(element); entry.known) reached.emplace_back(offset, entry);
    });
    for (const auto& [offset, entry] : reached) entries_[offset] = entry;
    exchange();
    return any(comm_, !reached.empty());
  }

 private:
  void exchange() {
    around_ = ring_.template gather<Entry>([this](const Index<Dim>& element) { return (*this)[element]; });
  }
  /// Returns the entry of an element that is owned or beside one that is.
  const Entry& around(const Index<Dim>& element) const { return around_[ring_.wanted().offset(element)]; }

  /// The difference to the neighbour on each side; where there is none, that of the other side or 0.
  void set_slopes(const Index<Dim>& element, Entry& entry) const {
    for (int axis = 0; axis < Dim; ++axis) {
      std::array<bool, 2> there{};
      for (const int side : {0, 1}) {
        Index<Dim> neighbour = element;
        neighbour[axis] += 2 * side - 1;
        there[side] = around(neighbour).known;
        if (there[side])
          entry.slopes[2 * axis + side] = (2 * side - 1) * (around(neighbour).value - entry.value);
      }
      for (const int side : {0, 1})
        if (!there[side] && beyond_ == BeyondCentres::slope)
          entry.slopes[2 * axis + side] = entry.slopes[2 * axis + 1 - side];
    }
  }

  /// The mean of what the known neighbours go on to: of those with a common face, or else edge, or corner.
  Entry from_neighbours(const Index<Dim>& element) const {
    const IndexBox<Dim> steps_around{{}, uniform_index<Dim>(3)};
    for (int apart = 1; apart <= Dim; ++apart) {
      Entry sum;
      int sources = 0;
      steps_around.for_each([&](const Index<Dim>& step, std::int64_t) {
        Index<Dim> neighbour = element;
        Point<Dim> away{};
        int steps = 0;
        for (int axis = 0; axis < Dim; ++axis) {
          neighbour[axis] += step[axis] - 1;
          away[axis] = 1.0 - step[axis];
          steps += step[axis] != 1 ? 1 : 0;
        }
        if (steps != apart || !around(neighbour).known) return;
        const Entry& from = around(neighbour);
        sum.value += from.at(away);
        for (std::size_t k = 0; k < sum.slopes.size(); ++k) sum.slopes[k] += from.slopes[k];
        ++sources;
      });
      if (sources == 0) continue;
      sum.known = true;
      sum.value /= sources;
      for (double& slope : sum.slopes) slope /= sources;
      return sum;
    }
    return {};
  }

  MPI_Comm comm_;
  BeyondCentres beyond_;
  IndexBox<Dim> owned_;
  BoxGather<Dim> ring_;
  std::vector<Entry> entries_, around_;  ///< of the owned elements; of them and those around them
};

}  // namespace

template <int Dim>
std::vector<double> refined_field(const Part<Dim>& part, std::span<const double> field, const Part<Dim>& fine,
                                  BeyondCentres beyond) {
  using Entry = typename CoarseField<Dim>::Entry;
  CoarseField<Dim> coarse(part, field, beyond);
  const IndexBox<Dim>& owned = fine.grid().owned_elements();
  const IndexBox<Dim> parents = owned.coarsened(uniform_index<Dim>(2));
  const BoxGather<Dim> to_fine(part.grid().comm(), part.grid().owned_elements(), parents);
  const auto parent = [&](int element) {
    Index<Dim> index = owned.index(element);
    for (int& i : index) i /= 2;
    return parents.offset(index);
  };
  std::vector<Entry> entries;
  const auto is_unknown = [&](int element) { return !entries[parent(element)].known; };
  const auto& elements = fine.elements();
  do entries = to_fine.template gather<Entry>([&](const Index<Dim>& element) { return coarse[element]; });
  while (any(part.grid().comm(), std::any_of(elements.begin(), elements.end(), is_unknown)) &&
         coarse.extend());
  std::vector<double> result;
  for (const int element : elements) {
    const Index<Dim> index = owned.index(element);
    Point<Dim> away;
    for (int axis = 0; axis < Dim; ++axis) away[axis] = index[axis] % 2 == 0 ? -0.25 : 0.25;
    result.push_back(entries[parent(element)].at(away));
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(refined_field);

}  // namespace fabseq
