// SPDX-License-Identifier: MIT
/// \file
/// Both ends of a heat adjoint, several rows at once (docs/formulation.md 8).
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/lanes/lane_vector.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence.h"

#include <span>
#include <vector>

namespace fabseq {

/// From derivatives by the pseudo-time to right-hand sides of adjoints, K_T lambda = -dJ/dT, and from the
/// adjoints to derivatives by the diffusivity, dJ/dkappa_e = lambda^T K_0 T. A row a lane.
template <int Dim>
class HeatChainRule {
 public:
  /// Both must outlive the object.
  HeatChainRule(const Part<Dim>& part, const ElementMatrices<Dim>& element);

  /// The temperature to differentiate at, on the ghosted node box.
  void set_temperature(std::span<const double> temperature);
  /// Right-hand sides on the owned nodes, with t = 1 - mean of T and grad t = -grad T. Collective.
  LaneVector loads(std::span<const TimeDerivatives> rows) const;
  /// Derivatives by the diffusivity of the part elements, one part field a lane of `adjoints` (on the owned
  /// nodes). Collective.
  std::vector<std::vector<double>> gradients(const LaneVector& adjoints) const;

 private:
  const Part<Dim>& part_;
  const ElementMatrices<Dim>& element_;
  std::vector<double> flux_;  ///< K_0 T, [part element][corner]
};

}  // namespace fabseq
