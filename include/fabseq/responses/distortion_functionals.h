// SPDX-License-Identifier: MIT
/// \file
/// Distortion as a sum of squares of a few linear functionals and a rest (docs/formulation.md 9).
#pragma once

#include "fabseq/responses/set_displacement.h"

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
/// psi_k the modes.
template <int Dim>
class DistortionFunctionals : public SumOfSquares<Dim> {
 public:
  /// \param factor J is `factor` times a sum of squares over the nodes
  /// \param asked_for what asked_for() returns
  DistortionFunctionals(const SetDisplacement<Dim>& set, SetModes modes, double factor, bool asked_for);

  bool uses_displacements() const override { return true; }
  std::vector<double> values(const PipelineState<Dim>& state) const override;
  void add_derivative(int component, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override;

  int count() const override { return static_cast<int>(modes_.modes.size()); }
  bool complete() const override { return modes_.complete; }
  bool asked_for() const override { return asked_for_; }

 private:
  SetDisplacement<Dim> set_;
  SetModes modes_;
  double root_of_factor_;
  bool asked_for_;
};

extern template class DistortionFunctionals<2>;
extern template class DistortionFunctionals<3>;

}  // namespace fabseq
