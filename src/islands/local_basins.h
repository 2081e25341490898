// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"
#include "islands/island_graph.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// This rank's part of the basins of a stiffness field, and the saddles between them and to those of other
/// ranks. Elements stiffer than all saddles where an island may end need no turns: there, a basin is a
/// component of neighbours across faces. The others rise in turn, into the basin of their stiffest neighbour;
/// if that is another rank's, a basin begins here that is a part of that one (Saddle::link).
template <int Dim>
class LocalBasins {
 public:
  /// The field of a lane.
  struct Field {
    IndexBox<Dim> whole;                ///< all elements of the box
    IndexBox<Dim> owned;                ///< this rank's
    std::span<const double> stiffness;  ///< on ringed(owned), lexicographic; 0 where there is nothing
    std::span<const char> supported;    ///< whether an element has a held node: on `owned`
  };

  /// `field` must outlive the object. Not collective.
  LocalBasins(const Field& field, const IslandLimits& limits, int rank);

  const std::vector<Basin>& basins() const { return basins_; }
  /// Basin of each owned element, an index into basins(); -1: too soft to be in one.
  const std::vector<int>& of_element() const { return of_element_; }
  /// The same, to keep: the object has them no more.
  std::vector<int> take_elements() { return std::move(of_element_); }
  /// The saddles that join components. `ids`: Basin::id of what elements of other ranks are in, on
  /// ringed(owned). Not collective.
  std::vector<Saddle> saddles(std::span<const std::int64_t> ids) const;
  /// Basins that may be islands or a part of one, by their indices: not those that meet no other and are
  /// none, or smaller than `most` others that meet none. `saddles`: of this rank.
  std::vector<int> candidates(const std::vector<Saddle>& saddles) const;

 private:
  /// An owned element and its place in the ring.
  struct Element {
    Index<Dim> index;
    std::int64_t owned, ringed;
  };

  static constexpr int faces = 2 * Dim;

  Element element(std::int64_t owned) const;
  /// Calls f(element) for the owned elements that rise, lexicographically.
  template <class Function>
  void for_each_risen(Function&& f) const;
  double stiffness_at(std::int64_t ringed) const { return field_.stiffness[ringed]; }
  bool rises(std::int64_t ringed) const { return field_.stiffness[ringed] >= limits_.floor; }
  bool in_core(double stiffness) const { return RiseOrder::depth_of(stiffness) < limits_.core_depth; }
  RiseOrder turn_of(const Element& element) const;
  /// Calls f(face, place in the ring, whether it is owned) for the neighbours that have risen earlier.
  template <class Function>
  void for_earlier(const Element& element, Function&& f) const;

  void find_core();
  void find_order();
  void let_rise(const Element& element);
  void add(const Element& element, int basin, bool alone);
  int append_basin();

  const Field& field_;
  IslandLimits limits_;
  IndexBox<Dim> ring_;
  std::array<std::int64_t, faces> to_face_{}, to_owned_face_{};  ///< steps across faces, in both boxes
  std::int64_t first_id_;
  std::vector<Basin> basins_;
  std::vector<char> meets_others_;  ///< whether a basin has neighbours on other ranks
  std::vector<int> of_element_;
  std::vector<std::int64_t> order_;  ///< elements outside the core, as they rise
};

}  // namespace fabseq
