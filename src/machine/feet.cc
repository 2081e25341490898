// SPDX-License-Identifier: MIT
#include "machine/feet.h"

#include <cmath>

namespace fabseq {

template <int Dim>
Feet<Dim>::Feet(const Part<Dim>& part, std::span<const double> direction, std::span<const double> layer_index,
                double bead_width)
    : part_(part),
      direction_(direction),
      layer_index_(layer_index),
      footing_(part.grid(), bead_width),
      steps_(footing_.steps()),
      halo_(part.grid(), reach_of<Dim>(steps_)),
      layers_(halo_.gather(part.expand(layer_index, INFINITY, 0.0))),
      normal_(part.plate().template normal<Dim>()) {}

template <int Dim>
const double* Feet<Dim>::direction_of(std::size_t e) const {
  if (direction_.empty()) return normal_.data();
  const double* own = &direction_[e * Dim];
  const bool vanishes = std::all_of(own, own + Dim, [](double component) { return component == 0.0; });
  return vanishes ? normal_.data() : own;
}

template <int Dim>
double Feet<Dim>::layer_of(const Index<Dim>& element) const {
  const auto [axis, upper] = part_.plate();
  if (upper ? element[axis] >= part_.grid().domain().elements[axis] : element[axis] < 0) return 0.0;
  return box().contains(element) ? layers_[box().offset(element)] : INFINITY;
}

FABSEQ_INSTANTIATE_CLASS(Feet);

}  // namespace fabseq
