// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

/// Part elements at which a check fails: how many, in which layers, and where. The same on all ranks.
struct MarkedElements {
  std::int64_t elements = 0;
  double share = 0.0;  ///< of the part's volume
  std::vector<std::int64_t> per_layer;
  double largest = 0.0;    ///< of the marks
  std::vector<double> at;  ///< centre of an element, [axis]; empty if there are none
};

/// Which of the marked elements MarkedElements::at names: the one with the largest mark, or one of the
/// earliest layer that has any. Of several it is the one that comes first in the grid.
enum class MarkedPlace { largest, earliest };

/// Counts marks (a part field; an element is marked if its mark is > 0). Collective on the grid's
/// communicator.
/// \param layer_index  the layer that builds each part element, from 1
/// \param layers       number of layers
template <int Dim>
MarkedElements count_marked(const Part<Dim>& part, std::span<const double> marks,
                            std::span<const double> layer_index, int layers, MarkedPlace place);

}  // namespace fabseq
