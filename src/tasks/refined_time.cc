// SPDX-License-Identifier: MIT
#include "tasks/refined_time.h"

#include "fabseq/base/mpi.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

namespace {

/// Empty where the gradient is not known, on all ranks.
template <int Dim>
std::vector<double> refined_gradient(const Part<Dim>& part, std::span<const double> gradient,
                                     const Part<Dim>& fine, BeyondCentres beyond) {
  if (!any(part.grid().comm(), !gradient.empty())) return {};
  std::vector<double> result(fine.elements().size() * Dim);
  std::vector<double> component(part.elements().size());
  for (int axis = 0; axis < Dim; ++axis) {
    for (std::size_t e = 0; e < component.size(); ++e) component[e] = gradient[e * Dim + axis];
    const std::vector<double> refined = refined_field<Dim>(part, component, fine, beyond);
    for (std::size_t e = 0; e < refined.size(); ++e) result[e * Dim + axis] = refined[e];
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
