// SPDX-License-Identifier: MIT
#include "fabseq/base/mpi.h"
#include "fabseq/solve/reference/preconditioner.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// A level's nodes on this rank: a coarse node belongs to the rank that owns the fine node it coincides with.
template <int Dim>
struct Level {
  Decomposition<Dim> ranges;  ///< of the nodes
  IndexBox<Dim> owned, ghosted;
  std::vector<PetscInt> numbers;  ///< of the ghosted nodes, -1: no unknown
  std::vector<int> unknowns;      ///< owned offsets
  std::int64_t count = 0;
};

template <int Dim>
Level<Dim> finest_level(const Grid<Dim>& grid) {
  Level<Dim> level;
  level.owned = grid.owned_nodes();
  level.ranges = grid.decomposition().of_nodes();
  return level;
}

/// The next coarser level's ranges and boxes; false if the grid cannot be coarsened further.
template <int Dim>
bool coarsen_boxes(const Grid<Dim>& grid, const Level<Dim>& fine, Level<Dim>& coarse) {
  coarse.ranges = fine.ranges;
  for (std::vector<int>& starts : coarse.ranges.range_starts) {
    if (starts.back() % 2 == 0) return false;
    for (int& start : starts) start = (start + 1) / 2;
    if (std::adjacent_find(starts.begin(), starts.end()) != starts.end()) return false;
  }
  coarse.owned = coarse.ranges.elements_of(coarse.ranges.position_of(rank_of(grid.comm())));
  IndexBox<Dim> all;
  for (int axis = 0; axis < Dim; ++axis) all.size[axis] = coarse.ranges.range_starts[axis].back();
  coarse.ghosted = ringed(coarse.owned).common_with(all);
  return true;
}

/// Calls f(coarse node, weight) for the coarse nodes that interpolate to a fine node.
template <int Dim, class Function>
void for_each_parent(const Index<Dim>& fine, Function&& f) {
  for (int corner = 0; corner < corner_count<Dim>; ++corner) {
    Index<Dim> parent{};
    double weight = 1.0;
    bool distinct = true;
    for (int axis = 0; axis < Dim; ++axis) {
      const int bit = (corner >> axis) & 1;
      const bool between = fine[axis] % 2 != 0;
      distinct = distinct && (between || bit == 0);
      parent[axis] = fine[axis] / 2 + (between ? bit : 0);
      if (between) weight *= 0.5;
    }
    if (distinct) f(parent, weight);
  }
}

template <int Dim>
void number_unknowns(const Grid<Dim>& grid, const Level<Dim>& fine, Level<Dim>& coarse) {
  const NodeExchange<Dim> exchange(grid.comm(), coarse.ranges, 1);
  std::vector<double> ghosted(static_cast<std::size_t>(coarse.ghosted.count()), 0.0);
  std::vector<double> owned(static_cast<std::size_t>(coarse.owned.count()));
  for (const int offset : fine.unknowns)
    for_each_parent<Dim>(fine.owned.index(offset), [&](const Index<Dim>& parent, double) {
      ghosted[coarse.ghosted.offset(parent)] += 1.0;
    });
  exchange.add_to_owned(ghosted, owned);
  for (std::size_t i = 0; i < owned.size(); ++i)
    if (owned[i] > 0.0) coarse.unknowns.push_back(static_cast<int>(i));
  std::int64_t number = exclusive_sum(grid.comm(), static_cast<std::int64_t>(coarse.unknowns.size()));
  coarse.count = sum(grid.comm(), static_cast<std::int64_t>(coarse.unknowns.size()));
  std::fill(owned.begin(), owned.end(), -1.0);
  for (const int offset : coarse.unknowns) owned[offset] = static_cast<double>(number++);
  exchange.to_ghosted(owned, ghosted);
  coarse.numbers.assign(ghosted.begin(), ghosted.end());
}

template <int Dim>
MatHandle interpolation(const Grid<Dim>& grid, int components, const Level<Dim>& fine,
                        const Level<Dim>& coarse) {
  MatHandle matrix;
  const auto rows = static_cast<PetscInt>(fine.unknowns.size()) * components;
  const auto columns = static_cast<PetscInt>(coarse.unknowns.size()) * components;
  check(MatCreateAIJ(grid.comm(), rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, corner_count<Dim>, nullptr,
                     corner_count<Dim>, nullptr, matrix.receive()));
  PetscInt row = 0;
  check(MatGetOwnershipRange(matrix, &row, nullptr));
  for (const int offset : fine.unknowns) {
    for_each_parent<Dim>(fine.owned.index(offset), [&](const Index<Dim>& parent, double weight) {
      const PetscInt number = coarse.numbers[coarse.ghosted.offset(parent)];
      for (int c = 0; c < components; ++c)
        check(MatSetValue(matrix, row + c, number * components + c, weight, INSERT_VALUES));
    });
    row += components;
  }
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  return matrix;
}

}  // namespace

template <int Dim>
std::string coarsening_obstacle(const Grid<Dim>& grid) {
  for (int axis = 0; axis < Dim; ++axis)
    if (grid.domain().elements[axis] % 2 != 0)
      return "an odd number of elements, " + std::to_string(grid.domain().elements[axis]) + ", along " +
             static_cast<char>('x' + axis);
  Level<Dim> coarse;
  if (coarsen_boxes(grid, finest_level(grid), coarse)) return "";
  return "too few elements for " + std::to_string(size_of(grid.comm())) + " ranks";
}

template <int Dim>
std::vector<MatHandle> make_interpolations(const UnknownNumbering<Dim>& numbering, std::int64_t coarsest) {
  const Grid<Dim>& grid = numbering.grid;
  Level<Dim> fine = finest_level(grid);
  fine.unknowns = numbering.owned_nodes;
  fine.count = numbering.count;
  std::vector<MatHandle> result;
  Level<Dim> coarse;
  while (fine.count > coarsest && coarsen_boxes(grid, fine, coarse)) {
    number_unknowns(grid, fine, coarse);
    result.push_back(interpolation(grid, numbering.components, fine, coarse));
    fine = std::move(coarse);
    coarse = Level<Dim>();
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(coarsening_obstacle);
FABSEQ_INSTANTIATE_FUNCTION(make_interpolations);

}  // namespace fabseq
