// SPDX-License-Identifier: MIT
#include "machine/place_form.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <cmath>
#include <limits>
#include <map>

namespace fabseq {

namespace {

template <int Dim>
Index<Dim> moved(Index<Dim> index, int axis, int by) {
  index[axis] += by;
  return index;
}

/// What is below a place, beside it and above.
template <int Dim>
class Surroundings {
 public:
  Surroundings(const Part<Dim>& part, std::span<const int> numbers, std::span<const int> place_of,
               std::span<const int> carrying, std::span<const double> layer_index)
      : part_(part),
        grid_(part.grid()),
        halo_(grid_, 1),
        solid_(halo_.gather(part.solid())),
        layers_(halo_.gather(part.expand(layer_index, INFINITY, 0.0))),
        up_(part.plate().upper ? -1 : 1),
        layer_index_(layer_index) {
    std::map<int, int> index_of;
    for (std::size_t p = 0; p < numbers.size(); ++p) index_of[numbers[p]] = static_cast<int>(p);
    const auto index = [&](int number) {
      const auto found = index_of.find(number);
      return found == index_of.end() ? -1 : found->second;
    };
    for (const int number : place_of) place_of_.push_back(index(number));
    for (const int number : carrying) carrying_.push_back(index(number));
    std::vector<double> stands;
    for (const int number : carrying) stands.push_back(number < 0 ? 1.0 : 0.0);
    stands_ = halo_.gather(part.expand(stands, 0.0, 1.0));
  }

  /// Places beside whose first layer, with what begins on it there, nothing stands by then. Collective.
  std::vector<bool> islands(const std::vector<Place>& places) const {
    std::vector<double> joined(places.size(), 0.0);
    for_each(carrying_, [&](std::size_t e, int place, const Index<Dim>& element) {
      if (layer_index_[e] > places[place].layer) return;
      ringed<Dim>({element, uniform_index<Dim>(1)}).for_each([&](const Index<Dim>& neighbor, std::int64_t) {
        if (at(stands_, neighbor, 0.0) > 0.0 && at(layers_, neighbor, INFINITY) <= layer_index_[e])
          joined[place] = 1.0;
      });
    });
    max_in_place(grid_.comm(), joined);
    std::vector<bool> result;
    for (const double value : joined) result.push_back(value == 0.0);
    return result;
  }

  /// Places over a void that walls close on both sides along an axis of the plate, and the part above all of
  /// it. Collective.
  std::vector<bool> roofs(const std::vector<Place>& places) const {
    const std::vector<std::int64_t> voids = voids_below(places);
    std::vector<int> rows = rows_through(voids);
    sum_in_place(grid_.comm(), std::span<int>(rows));
    std::vector<bool> result;
    std::size_t row = 0;
    for (const std::int64_t below : voids) {
      bool closed = false;
      for_each_row_axis([&](int axis) {
        const int length = grid_.domain().elements[axis];
        if (below >= 0)
          closed |= is_closed(std::span(rows).subspan(row, static_cast<std::size_t>(length)),
                              grid_.all_elements().index(below)[axis]);
        row += static_cast<std::size_t>(length);
      });
      result.push_back(closed);
    }
    return result;
  }

 private:
  enum Seen : int { open = 0, covered = 1, wall = 2 };

  template <class Function>
  void for_each(const std::vector<int>& place_of, const Function& f) const {
    for (std::size_t e = 0; e < place_of.size(); ++e)
      if (place_of[e] >= 0) f(e, place_of[e], grid_.owned_elements().index(part_.elements()[e]));
  }
  template <class Function>
  void for_each_row_axis(const Function& f) const {
    for (int axis = 0; axis < Dim; ++axis)
      if (axis != part_.plate().axis) f(axis);
  }
  double at(const std::vector<double>& field, const Index<Dim>& element, double outside) const {
    return halo_.box().contains(element) ? field[halo_.box().offset(element)] : outside;
  }
  bool is_solid(const Index<Dim>& element) const { return at(solid_, element, 0.0) > 0.0; }

  /// The void below an element of each place, that nearest to the place's centre, as a number in the grid;
  /// -1: there is none. Collective.
  std::vector<std::int64_t> voids_below(const std::vector<Place>& places) const {
    const double nobody = -std::numeric_limits<double>::infinity();
    std::vector<double> nearest(places.size(), nobody), first(places.size(), nobody);
    const auto for_each_void = [&](const auto& f) {
      for_each(place_of_, [&](std::size_t, int place, const Index<Dim>& element) {
        const Index<Dim> below = moved<Dim>(element, part_.plate().axis, -up_);
        if (is_solid(below) || !grid_.all_elements().contains(below)) return;
        const Point<Dim> here = grid_.element_center(element);
        double square = 0.0;
        for (int i = 0; i < Dim; ++i) square += std::pow(here[i] - places[place].centre[i], 2);
        f(place, -square, -static_cast<double>(grid_.all_elements().offset(below)));
      });
    };
    for_each_void([&](int p, double nearness, double) { nearest[p] = std::max(nearest[p], nearness); });
    max_in_place(grid_.comm(), nearest);
    for_each_void([&](int p, double nearness, double number) {
      if (nearness == nearest[p]) first[p] = std::max(first[p], number);
    });
    max_in_place(grid_.comm(), first);
    std::vector<std::int64_t> result;
    for (const double number : first)
      result.push_back(number == nobody ? -1 : static_cast<std::int64_t>(-number));
    return result;
  }

  /// What this rank owns of the rows of elements through each void, one after the other; else 0.
  std::vector<int> rows_through(const std::vector<std::int64_t>& voids) const {
    std::vector<int> rows;
    for (const std::int64_t below : voids)
      for_each_row_axis([&](int axis) {
        for (int i = 0; i < grid_.domain().elements[axis]; ++i) {
          rows.push_back(open);
          if (below < 0) continue;
          Index<Dim> element = grid_.all_elements().index(below);
          element[axis] = i;
          if (!grid_.owned_elements().contains(element)) continue;
          if (is_solid(element))
            rows.back() = wall;
          else if (is_solid(moved<Dim>(element, part_.plate().axis, up_)))
            rows.back() = covered;
        }
      });
    return rows;
  }

  static bool is_closed(std::span<const int> row, int from) {
    for (const int step : {-1, 1}) {
      int i = from;
      while (i >= 0 && i < static_cast<int>(row.size()) && row[i] == covered) i += step;
      if (i < 0 || i >= static_cast<int>(row.size()) || row[i] != wall) return false;
    }
    return true;
  }

  const Part<Dim>& part_;
  const Grid<Dim>& grid_;
  ElementHalo<Dim> halo_;
  std::vector<double> solid_, layers_,
      stands_;  ///< on the halo's box; stands_: nothing that hangs carries it
  int up_;      ///< step along the plate's axis
  std::span<const double> layer_index_;
  std::vector<int> place_of_, carrying_;  ///< index of the place of each part element, -1: none
};

}  // namespace

template <int Dim>
void tell_forms(const Part<Dim>& part, std::vector<Place>& places, std::span<const int> numbers,
                std::span<const int> place_of, std::span<const int> carrying,
                std::span<const double> layer_index) {
  const Surroundings<Dim> around(part, numbers, place_of, carrying, layer_index);
  const std::vector<bool> islands = around.islands(places), roofs = around.roofs(places);
  for (std::size_t p = 0; p < places.size(); ++p)
    places[p].form = roofs[p] ? PlaceForm::roof : islands[p] ? PlaceForm::island : PlaceForm::overhang;
}

FABSEQ_INSTANTIATE_FUNCTION(tell_forms);

}  // namespace fabseq
