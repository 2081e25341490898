// SPDX-License-Identifier: MIT
#include "tasks/refined_time.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace fabseq {

namespace {

/// Interpolates the gradient's length by itself: across a ridge, where layers of two sides meet, components
/// would cancel, and layers look thicker than on either side. Empty where the gradient is not known, on all
/// ranks.
template <int Dim>
std::vector<double> refined_gradient(const Part<Dim>& part, std::span<const double> gradient,
                                     const Part<Dim>& fine, BeyondCentres beyond) {
  if (!any(part.grid().comm(), !gradient.empty())) return {};
  std::vector<double> result(fine.elements().size() * Dim);
  std::vector<double> component(part.elements().size()), lengths(component.size());
  for (int axis = 0; axis < Dim; ++axis) {
    for (std::size_t e = 0; e < component.size(); ++e) {
      component[e] = gradient[e * Dim + axis];
      lengths[e] = std::hypot(lengths[e], component[e]);
    }
    const std::vector<double> refined = refined_field<Dim>(part, component, fine, beyond);
    for (std::size_t e = 0; e < refined.size(); ++e) result[e * Dim + axis] = refined[e];
  }
  lengths = refined_field<Dim>(part, lengths, fine, beyond);
  for (std::size_t e = 0; e < lengths.size(); ++e) {
    const std::span<double> vector(&result[e * Dim], Dim);
    const double length = std::sqrt(std::inner_product(vector.begin(), vector.end(), vector.begin(), 0.0));
    if (length <= 0.0) continue;
    for (double& value : vector) value *= std::max(0.0, lengths[e]) / length;
  }
  return result;
}

}  // namespace

template <int Dim>
PseudoTime<Dim> refined_time(const Part<Dim>& part, const PseudoTime<Dim>& time, const Part<Dim>& fine,
                             BeyondCentres beyond) {
  PseudoTime<Dim> result;
  result.time = refined_field<Dim>(part, time.time, fine);
  result.gradient = refined_gradient(part, time.gradient, fine, beyond);
  result.recorded_gradient = refined_gradient(part, time.recorded_gradient, fine, beyond);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(refined_time);

}  // namespace fabseq
