// SPDX-License-Identifier: MIT
/// \file
/// Small parts with unequal spacings and odd counts, and fields on them that do not depend on the rank count.
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/part/part.h"
#include "support/shapes.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace fabseq::test {

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;

/// A grid and a part that refers to it.
template <int Dim>
struct PartOnGrid {
  explicit PartOnGrid(const Domain<Dim>& domain, const Shape& shape,
                      const BuildPlate& plate = {Dim - 1, false}, MPI_Comm comm = PETSC_COMM_WORLD)
      : PartOnGrid(domain, PartDescription{shape, false}, plate, comm) {}
  PartOnGrid(const Domain<Dim>& domain, const PartDescription& description_,
             const BuildPlate& plate = {Dim - 1, false}, MPI_Comm comm = PETSC_COMM_WORLD)
      : description(description_),
        grid(make_balanced_grid<Dim>(comm, domain, description)),
        part(grid, description, plate) {}
  PartOnGrid(const PartOnGrid&) = delete;
  PartOnGrid& operator=(const PartOnGrid&) = delete;

  PartDescription description;
  Grid<Dim> grid;
  Part<Dim> part;
};

/// 7 x 5 or 5 x 3 x 5 elements of unequal edges.
template <int Dim>
Domain<Dim> odd_domain() {
  if constexpr (Dim == 2)
    return {{3.5, 1.5}, {7, 5}, 0.25};
  else
    return {{2.0, 0.9, 2.5}, {5, 3, 5}, 1.0};
}

/// The whole of odd_domain().
template <int Dim>
Shape block() {
  const auto size = odd_domain<Dim>().size;
  return box(std::vector<double>(Dim, 0.0), {size.begin(), size.end()});
}

/// A column with an overhanging arm, in odd_domain().
template <int Dim>
Shape gallows() {
  if constexpr (Dim == 2)
    return union_of({box({0, 0}, {1, 1.5}), box({0, 0.9}, {3, 1.5})});
  else
    return union_of({box({0, 0, 0}, {0.8, 0.9, 2.5}), box({0, 0, 1.5}, {2, 0.6, 2.5})});
}

/// A number in [0, 1) that looks random. Not inlined: contracted multiplications would give every caller
/// other bits.
[[gnu::noinline]] inline double noise(std::int64_t number, int salt = 0) {
  const double value = 43758.5453 * std::sin(12.9898 * static_cast<double>(number + 1) + 78.233 * salt);
  return value - std::floor(value);
}

/// Part field of f(lexicographic number of the element in the whole grid).
template <int Dim, class Function>
std::vector<double> part_field(const Part<Dim>& part, Function&& f) {
  std::vector<double> result;
  for (const int element : part.elements())
    result.push_back(f(part.grid().all_elements().offset(part.grid().owned_elements().index(element))));
  return result;
}

template <int Dim>
std::vector<double> noise_field(const Part<Dim>& part, double low, double high, int salt = 0) {
  return part_field(part, [&](std::int64_t number) { return low + (high - low) * noise(number, salt); });
}

/// Owned node field [node][component] of f(lexicographic number of the unknown in the whole grid).
template <int Dim, class Function>
std::vector<double> node_field(const Grid<Dim>& grid, int components, Function&& f) {
  std::vector<double> result;
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
    for (int c = 0; c < components; ++c) result.push_back(f(grid.all_nodes().offset(node) * components + c));
  });
  return result;
}

/// Part field on the whole grid, `outside` where there is no part. Collective.
template <int Dim>
std::vector<double> whole_part_field(const Part<Dim>& part, std::span<const double> field,
                                     double outside = 0.0) {
  return whole_element_field<Dim>(part.grid(), part.expand(field, outside));
}

/// a . b over all ranks. Collective.
inline double dot(std::span<const double> a, std::span<const double> b) {
  double product = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) product += a[i] * b[i];
  return sum(PETSC_COMM_WORLD, product);
}

inline double largest(std::span<const double> values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::abs(value));
  return result;
}

/// Largest difference relative to the largest entry of `expected`; infinite if the lengths differ.
inline double relative_difference(std::span<const double> actual, std::span<const double> expected) {
  if (actual.size() != expected.size()) return INFINITY;
  double difference = 0.0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    if (!std::isfinite(actual[i])) return INFINITY;
    difference = std::max(difference, std::abs(actual[i] - expected[i]));
  }
  return difference / std::max(largest(expected), 1e-300);
}

/// Central differences of the values of f along a line, extrapolated from steps h and h/2: error O(h^4).
template <class Function>
std::vector<double> central_differences(Function&& f, double h) {
  std::vector<double> result;
  for (const double step : {0.5 * h, h}) {
    const auto ahead = f(step), behind = f(-step);
    result.resize(ahead.size(), 0.0);
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] += (step < h ? 4.0 : -1.0) / 3.0 * (ahead[i] - behind[i]) / (2.0 * step);
  }
  return result;
}
template <class Function>
double central_difference(Function&& f, double h) {
  return central_differences([&](double step) { return std::array<double, 1>{f(step)}; }, h)[0];
}

/// x + step * direction.
inline std::vector<double> moved(std::span<const double> x, double step, std::span<const double> direction) {
  std::vector<double> result(x.begin(), x.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += step * direction[i];
  return result;
}

}  // namespace fabseq::test
