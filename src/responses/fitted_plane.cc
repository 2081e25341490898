// SPDX-License-Identifier: MIT
#include "fabseq/responses/fitted_plane.h"

#include "fabseq/base/blas.h"
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/responses/set_functions.h"

#include <string>

namespace fabseq {

namespace {

/// The two smallest variances must differ by more than this share of the largest one.
constexpr double least_difference = 1e-9;

/// Covariance of the set's nodes, their places relative to the set's extent. Collective.
template <int Dim>
std::array<Point<Dim>, Dim> covariance_of(const SetDisplacement<Dim>& set, const SetExtent<Dim>& extent) {
  std::vector<double> sums(static_cast<std::size_t>(Dim) * Dim, 0.0);
  for (const int node : set.nodes().owned) {
    const Point<Dim> x = extent.relative(set.position(node));
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) sums[a * Dim + b] += x[a] * x[b];
  }
  sum_in_place(set.comm(), sums);
  std::array<Point<Dim>, Dim> result;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) result[a][b] = sums[a * Dim + b] / static_cast<double>(set.nodes().count);
  return result;
}

}  // namespace

template <int Dim>
PrincipalAxes<Dim> principal_axes(std::array<Point<Dim>, Dim> covariance) {
  PrincipalAxes<Dim> result;
  const int size = Dim, work_size = 8 * Dim;
  std::array<double, 8 * Dim> work;
  int info = 0;
  dsyev_("V", "L", &size, covariance.front().data(), &size, result.variance.data(), work.data(), &work_size,
         &info);
  if (info != 0) throw NumericalError("dsyev failed for a covariance: " + std::to_string(info));
  result.direction = covariance;  // LAPACK's columns
  return result;
}

template <int Dim>
FittedPlane<Dim>::FittedPlane(const SetDisplacement<Dim>& set) : set_(set) {
  const SetExtent<Dim> extent = extent_of(set);
  const PrincipalAxes<Dim> axes = principal_axes<Dim>(covariance_of(set, extent));
  if (axes.variance[1] - axes.variance[0] <= least_difference * axes.variance.back())
    throw InputError("/node_sets/" + set.nodes().name + ": its " + std::to_string(set.nodes().count) +
                     " nodes determine no " + (Dim == 2 ? "line" : "plane") +
                     " for measure angle; allowed: nodes of " + (Dim == 2 ? "an edge" : "a face"));
  normal_ = axes.direction[0];
  for (int t = 0; t < tangents; ++t) {
    tangent_[t] = axes.direction[t + 1];
    // The coordinates along the axes are not correlated, so that each slope is a fit of its own.
    const double scale =
        1.0 / (static_cast<double>(set.nodes().count) * axes.variance[t + 1] * extent.radius);
    for (const int node : set.nodes().owned)
      slope_[t].push_back(scale * dot(tangent_[t], extent.relative(set.position(node))));
  }
}

template <int Dim>
Point<Dim> FittedPlane<Dim>::tilted(const PipelineState<Dim>& state) const {
  const std::vector<int>& nodes = set_.nodes().owned;
  std::array<double, tangents> slopes{};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    double along_normal = 0.0;
    for (int axis = 0; axis < Dim; ++axis) along_normal += normal_[axis] * set_.at(state, nodes[i], axis);
    for (int t = 0; t < tangents; ++t) slopes[t] += slope_[t][i] * along_normal;
  }
  sum_in_place(set_.comm(), slopes);
  Point<Dim> result = normal_;
  for (int t = 0; t < tangents; ++t)
    for (int axis = 0; axis < Dim; ++axis) result[axis] -= slopes[t] * tangent_[t][axis];
  return result;
}

template <int Dim>
void FittedPlane<Dim>::add_derivative(const Point<Dim>& gradient, const PipelineState<Dim>& state,
                                      PipelineAdjoint<Dim>& adjoint) const {
  const std::vector<int>& nodes = set_.nodes().owned;
  set_.prepare(state, adjoint);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int t = 0; t < tangents; ++t)
      for (int axis = 0; axis < Dim; ++axis)
        set_.add_derivative(nodes[i], axis, -dot(gradient, tangent_[t]) * slope_[t][i] * normal_[axis], state,
                            adjoint);
}

template PrincipalAxes<2> principal_axes<2>(std::array<Point<2>, 2> covariance);
template PrincipalAxes<3> principal_axes<3>(std::array<Point<3>, 3> covariance);
FABSEQ_INSTANTIATE_CLASS(FittedPlane);

}  // namespace fabseq
