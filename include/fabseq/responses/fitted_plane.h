// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/responses/set_displacement.h"

#include <array>

namespace fabseq {

/// Axes of a cloud of points: the eigenvectors of its covariance, of length 1, by ascending eigenvalue.
template <int Dim>
struct PrincipalAxes {
  std::array<double, Dim> variance{};
  std::array<Point<Dim>, Dim> direction{};
};

/// \param covariance [axis][axis], symmetric
template <int Dim>
PrincipalAxes<Dim> principal_axes(std::array<Point<Dim>, Dim> covariance);

/// The least-squares plane of a node set (in 2D the line), and how it tilts with displacements, to first
/// order: its normal n becomes n - sum_t t s_t, with s_t the slope of u . n along the plane's tangent t, from
/// a least-squares fit over the set (docs/formulation.md 5).
template <int Dim>
class FittedPlane {
 public:
  /// Collective on the grid's communicator. Throws InputError naming the node set if it determines no plane.
  explicit FittedPlane(const SetDisplacement<Dim>& set);

  /// Of the undeformed nodes, of length 1.
  const Point<Dim>& normal() const { return normal_; }
  /// Sets the normal to another vector of length 1 that differs from it by rounding, or by its sign.
  void set_normal(const Point<Dim>& normal) { normal_ = normal; }

  /// The normal of the displaced nodes; not of length 1. Collective.
  Point<Dim> tilted(const PipelineState<Dim>& state) const;
  /// Adds the derivative of `gradient` . tilted(). Local, on all ranks.
  void add_derivative(const Point<Dim>& gradient, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const;

 private:
  static constexpr int tangents = Dim - 1;

  SetDisplacement<Dim> set_;
  Point<Dim> normal_{};
  std::array<Point<Dim>, tangents> tangent_{};
  /// The products of these with u . n are its slopes along the tangents, 1/length.
  std::array<SetFunction, tangents> slope_;
};

}  // namespace fabseq
