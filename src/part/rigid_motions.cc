// SPDX-License-Identifier: MIT
#include "fabseq/part/rigid_motions.h"

#include "fabseq/base/mpi.h"

#include <cmath>
#include <utility>

namespace fabseq {

/// Pivots below this share of the number of nodes count as rounding.
constexpr double rounding = 1e-10;

template <int Dim>
RigidMotions<Dim>::RigidMotions(const Grid<Dim>& grid, std::vector<int> nodes)
    : grid_(grid), nodes_(std::move(nodes)) {
  std::vector<double> sums(Dim + 1, 0.0);  // of the positions, and the number of nodes
  for (const int node : nodes_) {
    const Point<Dim> x = grid.node_position(grid.owned_nodes().index(node));
    for (int axis = 0; axis < Dim; ++axis) sums[axis] += x[axis];
    sums[Dim] += 1.0;
  }
  sum_in_place(grid.comm(), sums);
  if (sums[Dim] == 0.0) return;
  for (int axis = 0; axis < Dim; ++axis) center_[axis] = sums[axis] / sums[Dim];
  double spread = 0.0;
  for (const int node : nodes_) {
    const Point<Dim> x = grid.node_position(grid.owned_nodes().index(node));
    for (int axis = 0; axis < Dim; ++axis) spread += std::pow(x[axis] - center_[axis], 2);
  }
  spread = sum(grid.comm(), spread);
  if (spread > 0.0) extent_ = std::sqrt(spread / sums[Dim]);

  for (const int node : nodes_) {
    const Point<Dim> x = position(grid.owned_nodes().index(node));
    for (int axis = 0; axis < Dim; ++axis) fit_.add(x, axis);
  }
  fit_.sum(grid.comm());
  determined_ = fit_.factor(0.0, rounding * sums[Dim]);
}

template <int Dim>
Point<Dim> RigidMotions<Dim>::position(const Index<Dim>& node) const {
  Point<Dim> x = grid_.node_position(node);
  for (int axis = 0; axis < Dim; ++axis) x[axis] = (x[axis] - center_[axis]) / extent_;
  return x;
}

template <int Dim>
void RigidMotions<Dim>::remove_fit(std::span<double> displacement) const {
  Amplitudes projections{};
  for (const int node : nodes_) {
    const Point<Dim> x = position(grid_.owned_nodes().index(node));
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        projections[k] +=
            rigid_motion<Dim>(k, axis, x) * displacement[static_cast<std::size_t>(node) * Dim + axis];
  }
  sum_in_place(grid_.comm(), projections);
  const Amplitudes fit = fit_.solve(projections);
  grid_.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    const Point<Dim> x = position(node);
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        displacement[offset * Dim + axis] -= fit[k] * rigid_motion<Dim>(k, axis, x);
  });
}

template <int Dim>
void RigidMotions<Dim>::balance(std::span<double> forces) const {
  Amplitudes resultants{};
  grid_.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    const Point<Dim> x = position(node);
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        resultants[k] += rigid_motion<Dim>(k, axis, x) * forces[offset * Dim + axis];
  });
  sum_in_place(grid_.comm(), resultants);
  const Amplitudes shares = fit_.solve(resultants);
  for (const int node : nodes_) {
    const Point<Dim> x = position(grid_.owned_nodes().index(node));
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        forces[static_cast<std::size_t>(node) * Dim + axis] -= shares[k] * rigid_motion<Dim>(k, axis, x);
  }
}

FABSEQ_INSTANTIATE_CLASS(RigidMotions);

}  // namespace fabseq
