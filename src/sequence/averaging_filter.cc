// SPDX-License-Identifier: MIT
#include "sequence/averaging_filter.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

template <int Dim>
AveragingFilter<Dim>::AveragingFilter(const Part<Dim>& part, double radius) : part_(part) {
  if (radius <= 0.0) return;
  const Grid<Dim>& grid = part.grid();
  Index<Dim> width;
  // However large the radius, no two elements are farther apart than the grid is long.
  for (int axis = 0; axis < Dim; ++axis)
    width[axis] = static_cast<int>(
        std::min(std::floor(radius / grid.spacing()[axis]), grid.domain().elements[axis] - 1.0));
  ringed<Dim>({{}, uniform_index<Dim>(1)}, width).for_each([&](const Index<Dim>& offset, std::int64_t) {
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(offset[axis] * grid.spacing()[axis], 2);
    const double weight = radius - std::sqrt(square);
    if (weight > 0.0) stencil_.push_back({offset, weight});
  });
  halo_.emplace(grid, width);
  const std::vector<double> ones(part.elements().size(), 1.0);
  in_part_ = halo_->gather(part.expand(ones));
  row_sum_.assign(part.elements().size(), 0.0);
  for_each_neighbour([&](std::size_t e, std::int64_t, double weight) { row_sum_[e] += weight; });
}

/// Calls f(part element, offset in the halo's box, weight) for every pair within the radius.
template <int Dim>
template <class Function>
void AveragingFilter<Dim>::for_each_neighbour(Function&& f) const {
  const auto& owned = part_.grid().owned_elements();
  for (std::size_t e = 0; e < part_.elements().size(); ++e) {
    const Index<Dim> center = owned.index(part_.elements()[e]);
    for (const Neighbour& neighbour : stencil_) {
      Index<Dim> other = center;
      for (int axis = 0; axis < Dim; ++axis) other[axis] += neighbour.offset[axis];
      if (!halo_->box().contains(other)) continue;
      const std::int64_t position = halo_->box().offset(other);
      if (in_part_[position] > 0.0) f(e, position, neighbour.weight);
    }
  }
}

template <int Dim>
std::vector<double> AveragingFilter<Dim>::apply(std::span<const double> part_field) const {
  std::vector<double> result(part_field.begin(), part_field.end());
  if (!halo_) return result;
  const std::vector<double> values = halo_->gather(part_.expand(part_field));
  std::fill(result.begin(), result.end(), 0.0);
  for_each_neighbour([&](std::size_t e, std::int64_t position, double weight) {
    result[e] += weight / row_sum_[e] * values[position];
  });
  return result;
}

template <int Dim>
std::vector<double> AveragingFilter<Dim>::apply_transpose(std::span<const double> part_field) const {
  if (!halo_) return {part_field.begin(), part_field.end()};
  std::vector<double> values(in_part_.size(), 0.0);
  for_each_neighbour([&](std::size_t e, std::int64_t position, double weight) {
    values[position] += weight / row_sum_[e] * part_field[e];
  });
  return part_.restrict_to_part(halo_->scatter_add(values));
}

FABSEQ_INSTANTIATE_CLASS(AveragingFilter);

}  // namespace fabseq
