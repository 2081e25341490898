// SPDX-License-Identifier: MIT
#include "sequence/drain_length.h"

#include "fabseq/base/mpi.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "sequence/heat_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fabseq {

namespace {

/// Share of the largest diffusivity that a section may need: a bar of one section needs half, and what is
/// left is the optimizer's.
constexpr double usable = 0.75;
/// Thickness of the slices of equal distance, in elements: with thinner ones, steps of the grid look like
/// narrow sections.
constexpr double slice_elements = 2.0;

/// Number of part elements in slices of that thickness (length unit) from the plate upwards, by their
/// distance from it. Collective.
template <int Dim>
std::vector<double> elements_in_slices(const Part<Dim>& part, double thickness) {
  const std::vector<double> distance = geodesic_distance(part);
  std::vector<double> result(static_cast<std::size_t>(geodesic_height(part, distance) / thickness) + 1, 0.0);
  for (const double at : distance)
    result[std::min(static_cast<std::size_t>(at / thickness), result.size() - 1)] += 1.0;
  sum_in_place(part.grid().comm(), result);
  return result;
}

}  // namespace

template <int Dim>
double drain_length(const Part<Dim>& part, const HeatSettings& settings, double height) {
  const double thickness = slice_elements * part.grid().largest_spacing();
  const std::vector<double> elements = elements_in_slices(part, thickness);
  // kappa(s) A(s) = alpha / g int_s A T ds, with T = 1 - g s and g = 1 / height.
  double drained = 0.0, needed = 0.0;
  for (std::size_t slice = elements.size() - 1; slice > 0; --slice) {
    const double middle = thickness * (static_cast<double>(slice) + 0.5);
    drained += elements[slice] * std::max(0.0, 1.0 - middle / height) * thickness;
    // At the lower end of the slice, through the section below it.
    needed = std::max(needed, settings.drain / height * drained / elements[slice - 1]);
  }
  return height * std::sqrt(std::max(1.0, needed / (usable * settings.max_diffusivity)));
}

FABSEQ_INSTANTIATE_FUNCTION(drain_length);

}  // namespace fabseq
