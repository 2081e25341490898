// SPDX-License-Identifier: MIT
/// \file
/// Where the exact checks of a sequence fail, put together to places (docs/formulation.md 13.4).
#pragma once

#include "fabseq/part/part.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// What is wrong with an element; the numbers are those of the field `fault`.
enum class Fault { hanging = 1, local_thickness = 2, tilt = 3, blocked = 4 };
inline constexpr std::array all_faults = {Fault::hanging, Fault::local_thickness, Fault::tilt,
                                          Fault::blocked};

/// What a place is, as far as it decides what a welder does about it.
enum class PlaceForm {
  none,
  roof,      ///< hanging: it closes a hole, a slot or an arch
  island,    ///< hanging: nothing earlier beside it
  overhang,  ///< hanging: any other
  thin,
  thick
};

/// Elements with one kind of fault that are connected, at least by a corner. The same on all ranks. Lengths
/// are in length units.
struct Place {
  Fault fault = Fault::hanging;
  PlaceForm form = PlaceForm::none;
  std::int64_t elements = 0;
  double volume = 0.0;  ///< of its elements, weighted by their density
  double begins = 0.0;  ///< volume of what begins on it, itself included
  /// Lengths along its axes: in the layer, the longer first, then in the build direction.
  std::vector<double> extent;
  std::vector<double> centre, lower, upper;  ///< its centre of volume and its box, [axis]
  int layer = 0;                             ///< the first that builds any of it, from 1
  double worst = 0.0;  ///< figure of the element that fails by most: thickness, degrees, depth

  /// Extent across the bead: the least one within the layer.
  double across() const { return extent[extent.size() - 2]; }
};

/// The bead by which places are measured, in length units.
struct Bead {
  double width = 0.0, height = 0.0;

  /// Whether a place is smaller: across the bead, and what begins on it against a bead as long as it is wide.
  bool is_larger_than(const Place& place) const;
};

/// The places of one kind, or of all.
struct Places {
  std::vector<Place> largest;  ///< those on which most begins, that first; at most most_places_told
  std::int64_t in_all = 0;
  double begins = 0.0;  ///< volume on all of them
};
inline constexpr std::size_t most_places_told = 50;

/// What is asked of a sequence to find its places. Refers to what it is made of.
struct CheckedLayers {
  std::span<const double> direction;    ///< build direction, [part element][axis]; may be empty
  std::span<const double> layer_index;  ///< the layer that builds each part element, from 1
  double bead_width = 0.0;              ///< length unit; 0: two elements' longest edges
};

/// Puts the elements with a mark > 0 together. Collective on the grid's communicator.
/// \param marks    by how much each part element fails, a part field
/// \param figures  what is told of it, Place::worst, a part field
template <int Dim>
Places find_places(const Part<Dim>& part, Fault fault, std::span<const double> marks,
                   std::span<const double> figures, const CheckedLayers& layers);

/// All places of several kinds, again the largest first.
Places merged(std::vector<Places> kinds);

}  // namespace fabseq
