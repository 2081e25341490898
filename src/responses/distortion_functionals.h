// SPDX-License-Identifier: MIT
/// \file
/// Functions over the nodes of a set, and distortion as a sum of squares of a few of its products with such
/// functions and a rest (docs/developer/optimizer.md 9.2).
#pragma once

#include "responses/set_displacement.h"

#include <optional>
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

/// Displacements of a node set, orthonormal over the nodes of all ranks, that a distortion measures each by
/// itself.
struct SetModes {
  std::vector<SetFunction> modes;  ///< [mode][owned node of the set][component]
  bool complete = false;           ///< whether the distortion measures nothing else
};

/// The linear displacements of a set, for a distortion that is a sum of squares over its nodes: for each
/// component the functions 1, x, y, z, in this order, each orthogonalized against those before it and left
/// out if it depends on them.
/// \param axes displacement components that the distortion measures
/// \param means whether the function 1 counts; without it the distortion measures deviations from the mean
///
/// Collective on the grid's communicator.
template <int Dim>
SetModes linear_modes(const SetDisplacement<Dim>& set, const std::vector<int>& axes, bool means);

/// The components r_k = sqrt(factor) psi_k . u of a distortion J = sum_k r_k^2 + rest, with rest >= 0 and
/// psi_k the modes; none without modes.
/// \param factor J is `factor` times a sum of squares over the nodes
template <int Dim>
std::optional<SumOfSquares<Dim>> sum_of_squares(const SetDisplacement<Dim>& set, SetModes modes,
                                                double factor, bool asked_for);

}  // namespace fabseq
