// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/element_halo.h"
#include "fabseq/machine/footing.h"
#include "fabseq/part/part.h"

#include <algorithm>
#include <span>
#include <vector>

namespace fabseq {

/// What each part element can rest on as a sequence builds it: the elements of the same or an earlier layer
/// within its footing, those of the substrate, and the plate (docs/formulation.md 13.1). Refers to its
/// arguments. Construction is collective on the grid's communicator.
template <int Dim>
class Feet {
 public:
  /// \param direction    build direction, [part element][axis]; the plate's normal where it vanishes, or if
  ///                     empty
  /// \param layer_index  the layer that builds each part element, from 1
  /// \param bead_width   length unit; 0: two elements' longest edges
  Feet(const Part<Dim>& part, std::span<const double> direction, std::span<const double> layer_index,
       double bead_width);

  /// The elements that feet may belong to, around the rank's own.
  const ElementHalo<Dim>& halo() const { return halo_; }
  const IndexBox<Dim>& box() const { return halo_.box(); }
  /// Whether part element e has a foot for which matches(index, layer) is true; layer 0 is that of the
  /// substrate and of the other side of the plate, which box() need not contain. Not collective.
  template <class Matches>
  bool any_of(std::size_t e, const Matches& matches) const {
    const Index<Dim> element = part_.grid().owned_elements().index(part_.elements()[e]);
    const double* axis = direction_of(e);
    return std::any_of(steps_.begin(), steps_.end(), [&](const Index<Dim>& step) {
      if (!footing_.holds(step, axis)) return false;
      Index<Dim> below = element;
      for (int i = 0; i < Dim; ++i) below[i] += step[i];
      const double layer = layer_of(below);
      return layer <= layer_index_[e] && matches(below, layer);
    });
  }

 private:
  const double* direction_of(std::size_t e) const;
  double layer_of(const Index<Dim>& element) const;

  const Part<Dim>& part_;
  std::span<const double> direction_, layer_index_;
  Footing<Dim> footing_;
  std::vector<Index<Dim>> steps_;
  ElementHalo<Dim> halo_;
  std::vector<double> layers_;  ///< on box(): 0 in the substrate, infinite outside of both
  Point<Dim> normal_;
};

}  // namespace fabseq
