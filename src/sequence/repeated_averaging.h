// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/design_support.h"

#include <span>
#include <vector>

namespace fabseq {

/// Smoothing of a direct design inside the part (docs/formulation.md 2.3). A pass replaces the values of
/// elements (nodes) by means over the nodes (elements) around them, which are in turn means over the elements
/// (nodes) around them. Smoothing follows the part: nothing passes through the void. Places without a
/// variable, which are those of the start region, stay 0. The number of passes is the one that comes nearest
/// to the spread of AveragingFilter's hat of the same radius. Radius 0 gives the identity.
template <int Dim>
class RepeatedAveraging {
 public:
  /// `radius`: length unit. Part and support must outlive the filter. Collective on the grid's communicator.
  RepeatedAveraging(const Part<Dim>& part, const DesignSupport<Dim>& support, double radius);

  int passes() const { return passes_; }
  /// Filtered variables. Collective on the grid's communicator.
  std::vector<double> apply(std::span<const double> design) const;
  /// Transpose of apply(). Collective on the grid's communicator.
  std::vector<double> apply_transpose(std::span<const double> design) const;

 private:
  /// Applies M, the means over the nodes of each part element (docs/formulation.md 2.3). Collective.
  std::vector<double> to_elements(std::span<const double> of_nodes) const;
  /// Applies the transpose of M. Collective.
  std::vector<double> to_nodes(std::span<const double> of_elements) const;
  /// Applies the inverse of D = diag(M^T 1), in place.
  void divide_by_weight(std::vector<double>& of_nodes) const;

  const Part<Dim>& part_;
  const DesignSupport<Dim>& support_;
  ElementMatrices<Dim> element_;
  int passes_;
  std::vector<double> weight_;  ///< [owned node]: its share of the part elements around it
};

}  // namespace fabseq
