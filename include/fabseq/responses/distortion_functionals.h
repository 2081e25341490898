// SPDX-License-Identifier: MIT
/// \file
/// Distortion as a sum of squares of few linear functionals and a rest (docs/formulation.md 9).
#pragma once

#include "fabseq/responses/set_displacement.h"

#include <memory>
#include <vector>

namespace fabseq {

/// The components r_k = a_k . u of a distortion J = sum_k r_k^2 + rest, rest >= 0: for each displacement
/// component that J measures the coefficients of its constant and linear part over the node set. These are
/// its products with functions that are orthonormal over the set's nodes, 1, x, y, z in this order less what
/// depends on those before.
template <int Dim>
class DistortionFunctionals : public Response<Dim> {
 public:
  /// \param axes     displacement components
  /// \param means    whether the constant parts count, too; without them J is one of deviations from the mean
  /// \param factor   J is `factor` times the sum of squares over the nodes
  /// Collective construction.
  DistortionFunctionals(const SetDisplacement<Dim>& set, std::vector<int> axes, bool means, double factor);

  std::string type() const override { return "least_squares"; }
  bool uses_displacements() const override { return true; }
  std::vector<double> values(const PipelineState<Dim>& state) const override;
  void add_derivative(int component, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override;

  /// Number of functionals.
  int count() const { return static_cast<int>(axes_.size() * functions_.size()); }
  /// Whether there is no rest, whatever the displacements: the set has no more nodes than there are
  /// functions.
  bool complete() const { return complete_; }

 private:
  SetDisplacement<Dim> set_;
  std::vector<int> axes_;
  double root_of_factor_;
  std::vector<std::vector<double>> functions_;  ///< [function][owned node of the set]
  bool complete_;
};

/// Of make_displacement_distortion() and make_flatness_distortion(), whose arguments these are.
template <int Dim>
std::unique_ptr<DistortionFunctionals<Dim>> make_displacement_functionals(const Part<Dim>& part,
                                                                          const NodeSet& nodes, bool mean,
                                                                          bool after_release);
template <int Dim>
std::unique_ptr<DistortionFunctionals<Dim>> make_flatness_functionals(const Part<Dim>& part,
                                                                      const NodeSet& nodes, int axis,
                                                                      bool after_release);

/// Registry (src/responses/registry.cc): the functionals of an objective term, nullptr if it has none.
template <int Dim>
std::unique_ptr<DistortionFunctionals<Dim>> make_functionals(const ObjectiveTerm& term,
                                                             const ResponseContext<Dim>& context);

extern template class DistortionFunctionals<2>;
extern template class DistortionFunctionals<3>;

}  // namespace fabseq
