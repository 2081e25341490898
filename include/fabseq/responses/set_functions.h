// SPDX-License-Identifier: MIT
/// \file
/// Functions over the nodes of a set that are orthonormal over those of all ranks, and the set's extent.
#pragma once

#include "fabseq/responses/set_displacement.h"

#include <span>
#include <vector>

namespace fabseq {

/// What orthogonalization leaves of a function counts as rounding up to this share of its size.
constexpr double dependent_share = 1e-9;

/// Functions whose products, summed over the set's nodes of all ranks, are 1 with themselves and 0 with each
/// other.
class OrthonormalFunctions {
 public:
  explicit OrthonormalFunctions(MPI_Comm comm) : comm_(comm) {}

  /// Adds what a function has beyond those before it. Returns false, and adds nothing, if the root of the sum
  /// of its squares is at most `least`. Collective.
  bool add(SetFunction function, double least);
  /// Takes from a function what it has in common with these. Collective.
  void remove_from(SetFunction& function) const;

  const std::vector<SetFunction>& functions() const { return functions_; }
  std::size_t count() const { return functions_.size(); }

 private:
  double dot(const SetFunction& a, const SetFunction& b) const;

  MPI_Comm comm_;
  std::vector<SetFunction> functions_;
};

/// Where a set of nodes lies; the same on all ranks.
template <int Dim>
struct SetExtent {
  Point<Dim> center{};  ///< mean of the nodes' positions, length unit
  double radius = 0.0;  ///< largest distance of a node from the centre, length unit

  /// A position seen from the centre, relative to the radius.
  Point<Dim> relative(Point<Dim> position) const;
};

/// Collective on the grid's communicator.
template <int Dim>
SetExtent<Dim> extent_of(const SetDisplacement<Dim>& set);

}  // namespace fabseq
