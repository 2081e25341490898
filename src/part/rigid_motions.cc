// SPDX-License-Identifier: MIT
#include "fabseq/part/rigid_motions.h"

#include "fabseq/base/mpi.h"

#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// Pivots below this share of the diagonal are rounding.
constexpr double rounding = 1e-10;

}  // namespace

template <int Dim>
RigidMotions<Dim>::RigidMotions(const Grid<Dim>& grid, std::vector<int> nodes)
    : grid_(grid), nodes_(std::move(nodes)) {
  std::vector<double> sums(Dim + 1, 0.0);  // positions, number
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

  std::vector<double> normal(static_cast<std::size_t>(count) * count, 0.0);
  for (const int node : nodes_) {
    const Index<Dim> index = grid.owned_nodes().index(node);
    for (int k = 0; k < count; ++k)
      for (int l = 0; l < count; ++l)
        for (int axis = 0; axis < Dim; ++axis)
          normal[k * count + l] += mode(k, index)[axis] * mode(l, index)[axis];
  }
  sum_in_place(grid.comm(), normal);
  factor(std::move(normal));
}

template <int Dim>
Point<Dim> RigidMotions<Dim>::mode(int number, const Index<Dim>& node) const {
  Point<Dim> result{};
  if (number < Dim) {
    result[number] = 1.0;
    return result;
  }
  const Point<Dim> x = grid_.node_position(node);
  const int a = Dim == 2 ? 0 : (number - Dim + 1) % Dim;
  const int b = Dim == 2 ? 1 : (number - Dim + 2) % Dim;
  result[a] = -(x[b] - center_[b]) / extent_;
  result[b] = (x[a] - center_[a]) / extent_;
  return result;
}

template <int Dim>
void RigidMotions<Dim>::factor(std::vector<double> normal) {
  determined_ = true;
  for (int column = 0; column < count && determined_; ++column)
    for (int row = column; row < count; ++row) {
      double value = normal[row * count + column];
      for (int k = 0; k < column; ++k) value -= factor_[row][k] * factor_[column][k];
      if (row == column) {
        determined_ = value > rounding * normal[0];
        if (!determined_) return;
      }
      factor_[row][column] = row == column ? std::sqrt(value) : value / factor_[column][column];
    }
}

template <int Dim>
typename RigidMotions<Dim>::Amplitudes RigidMotions<Dim>::solve(Amplitudes right) const {
  for (int row = 0; row < count; ++row) {
    for (int k = 0; k < row; ++k) right[row] -= factor_[row][k] * right[k];
    right[row] /= factor_[row][row];
  }
  for (int row = count - 1; row >= 0; --row) {
    for (int k = row + 1; k < count; ++k) right[row] -= factor_[k][row] * right[k];
    right[row] /= factor_[row][row];
  }
  return right;
}

template <int Dim>
void RigidMotions<Dim>::remove_fit(std::span<double> displacement) const {
  Amplitudes projections{};
  for (const int node : nodes_) {
    const Index<Dim> index = grid_.owned_nodes().index(node);
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        projections[k] += mode(k, index)[axis] * displacement[static_cast<std::size_t>(node) * Dim + axis];
  }
  sum_in_place(grid_.comm(), projections);
  const Amplitudes fit = solve(projections);
  grid_.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        displacement[offset * Dim + axis] -= fit[k] * mode(k, node)[axis];
  });
}

template <int Dim>
void RigidMotions<Dim>::balance(std::span<double> forces) const {
  Amplitudes resultants{};
  grid_.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        resultants[k] += mode(k, node)[axis] * forces[offset * Dim + axis];
  });
  sum_in_place(grid_.comm(), resultants);
  const Amplitudes shares = solve(resultants);
  for (const int node : nodes_) {
    const Index<Dim> index = grid_.owned_nodes().index(node);
    for (int k = 0; k < count; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        forces[static_cast<std::size_t>(node) * Dim + axis] -= shares[k] * mode(k, index)[axis];
  }
}

template class RigidMotions<2>;
template class RigidMotions<3>;

}  // namespace fabseq
