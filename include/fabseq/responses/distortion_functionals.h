// SPDX-License-Identifier: MIT
/// \file
/// Distortion as a sum of squares of a few linear functionals and a rest (docs/formulation.md 9).
#pragma once

#include "fabseq/responses/set_displacement.h"

#include <optional>
#include <vector>

namespace fabseq {

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
