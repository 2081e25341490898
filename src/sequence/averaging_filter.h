// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/element_halo.h"
#include "fabseq/part/part.h"

#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// Filter of a part field: weighted mean over the part elements within `radius`, with weights that fall
/// linearly with the distance (docs/formulation.md 2.2). Radius 0 gives the identity.
template <int Dim>
class AveragingFilter {
 public:
  /// `radius`: length unit. The part must outlive the filter. Collective on the grid's communicator.
  AveragingFilter(const Part<Dim>& part, double radius);

  /// Filtered part field. Collective on the grid's communicator.
  std::vector<double> apply(std::span<const double> part_field) const;
  /// Transpose of apply(). Collective on the grid's communicator.
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
  std::vector<double> in_part_;  ///< on the halo's box: 1 for part elements
  std::vector<double> row_sum_;  ///< part field: sum of the weights of each mean
};

}  // namespace fabseq
