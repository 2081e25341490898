// SPDX-License-Identifier: MIT
#include "machine/time_differences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace fabseq {

namespace {

constexpr double outside = std::numeric_limits<double>::quiet_NaN();
/// Share of a fit's largest moment that stands for rounding: directions in which the elements around one have
/// no extent get no slope.
constexpr double no_extent = 1e-10;
/// Differences below this share of the largest around an element are rounding, as where fronts meet evenly.
constexpr double no_difference = 1e-9;

template <int Dim>
using Moments = std::array<Point<Dim>, Dim>;

/// Solution of a positive definite system by Cholesky's factors; `matrix` is overwritten.
template <int Dim>
Point<Dim> solved(Moments<Dim> matrix, Point<Dim> right) {
  for (int i = 0; i < Dim; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = matrix[i][j];
      for (int k = 0; k < j; ++k) sum -= matrix[i][k] * matrix[j][k];
      matrix[i][j] = i == j ? std::sqrt(sum) : sum / matrix[j][j];
    }
    for (int k = 0; k < i; ++k) right[i] -= matrix[i][k] * right[k];
    right[i] /= matrix[i][i];
  }
  for (int i = Dim - 1; i >= 0; --i) {
    for (int k = i + 1; k < Dim; ++k) right[i] -= matrix[k][i] * right[k];
    right[i] /= matrix[i][i];
  }
  return right;
}

}  // namespace

/// Weighted sums over the elements around one; `step` is counted in elements, times from the element's own.
template <int Dim>
struct TimeDifferences<Dim>::Sums {
  double weight = 0.0, time = 0.0, largest = 0.0;
  Point<Dim> step{}, step_time{};
  Moments<Dim> step_step{};

  void add(double w, const Point<Dim>& x, double t) {
    weight += w;
    time += w * t;
    largest = std::max(largest, std::abs(t));
    for (int i = 0; i < Dim; ++i) {
      step[i] += w * x[i];
      step_time[i] += w * x[i] * t;
      for (int j = 0; j < Dim; ++j) step_step[i][j] += w * x[i] * x[j];
    }
  }

  /// Slope of the fit, per element along each axis.
  Point<Dim> slope() const {
    Moments<Dim> matrix = step_step;
    Point<Dim> right = step_time;
    double trace = 0.0;
    for (int i = 0; i < Dim; ++i) {
      right[i] -= step[i] * time / weight;
      for (int j = 0; j < Dim; ++j) matrix[i][j] -= step[i] * step[j] / weight;
      trace += matrix[i][i];
    }
    if (!(trace > 0.0)) return {};  // a single element
    for (int i = 0; i < Dim; ++i) matrix[i][i] += no_extent * trace;
    Point<Dim> result = solved<Dim>(matrix, right);
    double size = 0.0;
    for (const double component : result) size = std::max(size, std::abs(component));
    return size > no_difference * largest ? result : Point<Dim>{};
  }
};

template <int Dim>
TimeDifferences<Dim>::TimeDifferences(const Part<Dim>& part, std::span<const double> time,
                                      const Index<Dim>& reach)
    : part_(part),
      reach_(reach),
      halo_(part.grid(), reach),
      time_(halo_.gather(part.expand(time, outside, outside))) {}

template <int Dim>
typename TimeDifferences<Dim>::Sums TimeDifferences<Dim>::sums_around(const Index<Dim>& element,
                                                                      std::vector<int>& visited,
                                                                      std::vector<Index<Dim>>& front) const {
  const IndexBox<Dim>& box = halo_.box();
  const double own = time_[box.offset(element)];
  IndexBox<Dim> window;
  for (int axis = 0; axis < Dim; ++axis) {
    window.start[axis] = element[axis] - reach_[axis];
    window.size[axis] = 2 * reach_[axis] + 1;
  }
  visited.assign(static_cast<std::size_t>(window.count()), 0);
  front.assign(1, element);
  visited[window.offset(element)] = 1;
  Sums sums;
  while (!front.empty()) {
    const Index<Dim> here = front.back();
    front.pop_back();
    double weight = 1.0;
    Point<Dim> step;
    for (int axis = 0; axis < Dim; ++axis) {
      step[axis] = here[axis] - element[axis];
      weight *= reach_[axis] + 1 - std::abs(step[axis]);
    }
    sums.add(weight, step, time_[box.offset(here)] - own);
    for (int face = 0; face < 2 * Dim; ++face) {
      Index<Dim> next = here;
      next[face / 2] += face % 2 == 0 ? -1 : 1;
      if (!window.contains(next) || !box.contains(next) || visited[window.offset(next)] != 0) continue;
      visited[window.offset(next)] = 1;
      if (!std::isnan(time_[box.offset(next)])) front.push_back(next);
    }
  }
  return sums;
}

template <int Dim>
std::vector<double> TimeDifferences<Dim>::gradient() const {
  const Grid<Dim>& grid = part_.grid();
  std::vector<int> visited;
  std::vector<Index<Dim>> front;
  std::vector<double> result;
  for (const int element : part_.elements()) {
    const Point<Dim> slope = sums_around(grid.owned_elements().index(element), visited, front).slope();
    for (int axis = 0; axis < Dim; ++axis) result.push_back(slope[axis] / grid.spacing()[axis]);
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(TimeDifferences);

}  // namespace fabseq
