// SPDX-License-Identifier: MIT
#include "fabseq/machine/built_layers.h"

namespace fabseq {

template <int Dim>
std::vector<double> built_layers(const Part<Dim>& part, std::span<const double> layer_index) {
  std::vector<double> layer = part.expand(layer_index, never_built);
  const auto& substrate = part.substrate().elements();
  for (std::size_t element = 0; element < substrate.size(); ++element)
    if (substrate[element] != 0) layer[element] = 0.0;
  return layer;
}

FABSEQ_INSTANTIATE_FUNCTION(built_layers);

}  // namespace fabseq
