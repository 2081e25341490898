// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/element_halo.h"
#include "fabseq/part/part.h"

#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// Weighted mean over the part elements within `radius`, weights falling linearly with the distance
/// (docs/formulation.md 2.2). Radius 0: the identity.
template <int Dim>
class AveragingFilter {
 public:
  /// `radius` in length units. Collective; the part must outlive the filter.
  AveragingFilter(const Part<Dim>& part, double radius);

  /// Filtered part field. Collective.
  std::vector<double> apply(std::span<const double> part_field) const;
  /// Transpose of apply(). Collective.
  std::vector<double> apply_transpose(std::span<const double> part_field) const;

 private:
  struct Neighbour {
    Index<Dim> offset{};
    double weight = 0.0;
  };
  template <class Function>
  void for_each_neighbour(Function&& f) const;

  const Part<Dim>& part_;
  std::optional<ElementHalo<Dim>> halo_;
  std::vector<Neighbour> stencil_;
  std::vector<double> in_part_;  ///< 1 for part elements of the halo's box
  std::vector<double> row_sum_;  ///< a part field
};

}  // namespace fabseq
