// SPDX-License-Identifier: MIT
#include "cg/free_motions.h"

#include "fabseq/base/mpi.h"

#include <array>
#include <cmath>

namespace fabseq {

template <int Dim>
FreeMotions<Dim>::FreeMotions(LaneLevel<Dim>& level, std::span<const double> stiffness)
    : level_(level),
      positions_(level.node_positions()),
      stiffness_(static_cast<std::size_t>(level.mesh.nodes()), 0.0) {
  std::array<double, Dim + 1> center{};  // sums of positions, number
  for (const auto& range : level.counted)
    for (std::int64_t node = range.begin; node < range.end; ++node) {
      for (int axis = 0; axis < Dim; ++axis) center[axis] += positions_[node][axis];
      center[Dim] += 1.0;
    }
  sum_in_place(level.comm, center);
  double extent = 0.0;
  for (int axis = 0; axis < Dim; ++axis) extent += std::pow(level.elements[axis] * level.spacing[axis], 2);
  for (Point<Dim>& position : positions_)
    for (int axis = 0; axis < Dim; ++axis)
      position[axis] = (position[axis] - center[axis] / center[Dim]) / std::sqrt(extent);

  for (const auto& row : level.mesh.rows())
    for (int e = 0; e < row.length; ++e)
      for (const std::int64_t node : row.node)
        for (int side = 0; side < 2; ++side) stiffness_[node + e + side] += stiffness[row.element + e];
  sum_over_holders(level, stiffness_.data(), 1);

  displacements_ = fit([](std::int64_t) { return 1.0; });
  forces_ = fit([this](std::int64_t node) { return stiffness_[node]; });
}

/// Factor of R^T W R, `weight` being W's entry of a node.
template <int Dim>
template <class Weight>
RigidFit<Dim> FreeMotions<Dim>::fit(Weight&& weight) const {
  RigidFit<Dim> result;
  for (const auto& range : level_.counted)
    for (std::int64_t node = range.begin; node < range.end; ++node)
      for (int axis = 0; axis < Dim; ++axis) result.add(positions_[node], axis, weight(node));
  result.sum(level_.comm);
  result.factor(0.0);
  return result;
}

/// values -= W R (R^T W R)^-1 R^T values
template <int Dim>
template <class Real, class Weight>
void FreeMotions<Dim>::project(LaneValues<Real>& values, const RigidFit<Dim>& fit, Weight&& weight) const {
  typename RigidFit<Dim>::Amplitudes amplitudes{};
  for (const auto& range : level_.counted)
    for (std::int64_t node = range.begin; node < range.end; ++node)
      for (int k = 0; k < fit.count; ++k)
        for (int axis = 0; axis < Dim; ++axis)
          amplitudes[k] += rigid_motion<Dim>(k, axis, positions_[node]) * values[node * Dim + axis];
  sum_in_place(level_.comm, amplitudes);
  amplitudes = fit.solve(amplitudes);
  for (std::int64_t node = 0; node < level_.mesh.nodes(); ++node)
    for (int axis = 0; axis < Dim; ++axis) {
      double value = values[node * Dim + axis];  // what the motions take away may be all but a little of it
      for (int k = 0; k < fit.count; ++k)
        value -= weight(node) * amplitudes[k] * rigid_motion<Dim>(k, axis, positions_[node]);
      values[node * Dim + axis] = static_cast<Real>(value);
    }
}

template <int Dim>
void FreeMotions<Dim>::remove(LaneValues<float>& displacement) const {
  project(displacement, displacements_, [](std::int64_t) { return 1.0; });
}

template <int Dim>
void FreeMotions<Dim>::balance(LaneArray& forces) const {
  project(forces, forces_, [this](std::int64_t node) { return stiffness_[node]; });
}

FABSEQ_INSTANTIATE_CLASS(FreeMotions);

}  // namespace fabseq
