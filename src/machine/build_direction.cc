// SPDX-License-Identifier: MIT
#include "fabseq/machine/build_direction.h"

#include <cmath>

namespace fabseq {

template <int Dim>
std::vector<double> build_direction(std::span<const double> gradient, const LayerDensities& layers,
                                    std::span<const double> layer_index) {
  const SubParts& sub_parts = layers.sub_parts;
  std::vector<double> result(gradient.begin(), gradient.end());
  if (sub_parts.count() > 0) {
    result.resize(layer_index.size() * Dim);
    for (std::size_t e = 0; e < layer_index.size(); ++e) {
      const int sub_part = sub_parts.of_layer[static_cast<std::size_t>(layer_index[e]) - 1];
      for (int axis = 0; axis < Dim; ++axis)
        result[e * Dim + axis] = sub_parts.directions[static_cast<std::size_t>(sub_part) * Dim + axis];
    }
  }
  for (std::size_t e = 0; e * Dim < result.size(); ++e) {
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += result[e * Dim + axis] * result[e * Dim + axis];
    for (int axis = 0; axis < Dim && square > 0.0; ++axis) result[e * Dim + axis] /= std::sqrt(square);
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(build_direction);

}  // namespace fabseq
