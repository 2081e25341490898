// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/pieces.h"

#include <array>

namespace fabseq {

/// Build directions as tilt vectors (docs/formulation.md 2.4). A tilt vector points where the direction leans
/// from the plate's normal, and is as long as the angle between them, in radians. Its components are those
/// along the other axes of the box, in their order. Nothing here is collective.
template <int Dim>
class TiltVectors {
 public:
  static constexpr int components = Dim - 1;

  explicit TiltVectors(const BuildPlate& plate);

  /// d = up cos|a| + (sum_i a_i e_i) sin|a| / |a|, of unit length. `tilt`: a, [component].
  Point<Dim> direction(const double* tilt) const;
  /// Adds the derivative with respect to a to d_tilt, [component]. \param d_direction  dJ/dd
  void add_derivative(const double* tilt, const Point<Dim>& d_direction, double* d_tilt) const;
  /// The tilt vector of a direction of any length; 0 for both directions along the plate's normal.
  std::array<double, components> tilt_of(const Point<Dim>& direction) const;

 private:
  Point<Dim> up_;
  std::array<int, components> axes_;  ///< of the box, those along the plate
};

}  // namespace fabseq
