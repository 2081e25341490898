// SPDX-License-Identifier: MIT
#include "fabseq/machine/hanging.h"

#include "machine/feet.h"

namespace fabseq {

template <int Dim>
std::vector<double> hanging_elements(const Part<Dim>& part, std::span<const double> direction,
                                     std::span<const double> layer_index, double bead_width) {
  const Feet<Dim> feet(part, direction, layer_index, bead_width);
  std::vector<double> result(layer_index.size());
  for (std::size_t e = 0; e < result.size(); ++e)
    result[e] = feet.any_of(e, [](const Index<Dim>&, double) { return true; }) ? 0.0 : 1.0;
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(hanging_elements);

}  // namespace fabseq
