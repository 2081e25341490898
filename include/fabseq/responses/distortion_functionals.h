// SPDX-License-Identifier: MIT
/// \file
/// Distortion as a sum of squares of a few linear functionals and a rest (docs/formulation.md 9).
#pragma once

#include "fabseq/responses/set_displacement.h"

#include <memory>
#include <vector>

namespace fabseq {

/// The components r_k = a_k . u of a distortion J = sum_k r_k^2 + rest, with rest >= 0. For each displacement
/// component that J measures, they are the coefficients of its constant and linear part over the node set:
/// its products with functions that are orthonormal over the nodes of the set. These functions are 1, x, y,
/// z, in this order, each orthogonalized against those before it and left out if it depends on them.
template <int Dim>
class DistortionFunctionals : public SumOfSquares<Dim> {
 public:
  /// \param axes displacement components that J measures
  /// \param means whether the constant parts count; without them J measures deviations from the mean
  /// \param factor J is `factor` times the sum of squares over the nodes
  /// \param asked_for what asked_for() returns
  ///
  /// Collective on the grid's communicator.
  DistortionFunctionals(const SetDisplacement<Dim>& set, std::vector<int> axes, bool means, double factor,
                        bool asked_for);

  std::string type() const override { return "least_squares"; }
  bool uses_displacements() const override { return true; }
  std::vector<double> values(const PipelineState<Dim>& state) const override;
  void add_derivative(int component, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override;

  int count() const override { return static_cast<int>(axes_.size() * functions_.size()); }
  /// There is no rest if the set has no more nodes than there are functions.
  bool complete() const override { return complete_; }
  bool asked_for() const override { return asked_for_; }

 private:
  SetDisplacement<Dim> set_;
  std::vector<int> axes_;
  double root_of_factor_;
  bool asked_for_;
  std::vector<std::vector<double>> functions_;  ///< [function][owned node of the set]
  bool complete_;
};

extern template class DistortionFunctionals<2>;
extern template class DistortionFunctionals<3>;

}  // namespace fabseq
