// SPDX-License-Identifier: MIT
/// \file
/// Numbers of a config that are valid but cannot be meant, such as values in another unit.
#pragma once

#include "fabseq/model/model.h"

#include <string>
#include <vector>

namespace fabseq {

/// What is known of a part once it lies in its grid; lengths in the config's unit.
struct PartFigures {
  double volume, longest_edge;  ///< of the part
  double smallest_spacing;      ///< edge of an element
  int layers;

  template <int Dim>
  explicit PartFigures(const Model<Dim>& model)
      : volume(model.part.volume()),
        longest_edge(model.part.longest_edge()),
        smallest_spacing(model.grid.smallest_spacing()),
        layers(model.layers->count()) {}
  PartFigures(double volume_, double longest_edge_, double smallest_spacing_, int layers_)
      : volume(volume_), longest_edge(longest_edge_), smallest_spacing(smallest_spacing_), layers(layers_) {}
};

/// A line for each of them: its key, what was found, what is expected. Where only the unit of length could
/// tell, nothing is said unless domain.unit names it. Not collective; the same on all ranks.
std::vector<std::string> unlikely_numbers(const ModelSettings& settings, const PartFigures& part);

}  // namespace fabseq
