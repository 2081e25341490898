// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/part/pieces.h"
#include "fabseq/part/shape.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace fabseq {

/// Elements that stand from the start and are no part of what is built, such as a base plate
/// (docs/formulation.md 4.4); there may be none.
template <int Dim>
class Substrate {
 public:
  /// Collective on the grid's communicator. Elements whose centre lies in `shape`; no reference to it is
  /// kept. Throws InputError if a shape is given that holds none.
  Substrate(const Grid<Dim>& grid, const std::optional<Shape>& shape);

  /// Elements of all ranks.
  std::int64_t count() const { return count_; }
  /// 1 for the owned elements of the grid that belong to it, lexicographic in Grid::owned_elements().
  const std::vector<char>& elements() const { return elements_; }
  /// 1 for the owned nodes of such elements, of any rank, lexicographic in Grid::owned_nodes().
  const std::vector<char>& nodes() const { return nodes_; }
  /// 1 for the nodes on its side towards the plate: the lowest ones along the plate's normal. Collective.
  std::vector<char> nodes_towards(const BuildPlate& plate) const;
  /// For each owned element, half the spacing across a face that it shares with the substrate (the smallest
  /// one), or infinity. Collective.
  std::vector<double> contact_distance() const;

 private:
  const Grid<Dim>& grid_;
  std::vector<char> elements_, nodes_;
  std::int64_t count_ = 0;
};

/// Owned nodes of the given owned elements (1 or 0 each), of any rank. Collective.
template <int Dim>
std::vector<char> nodes_of_elements(const Grid<Dim>& grid, const std::vector<char>& elements);

}  // namespace fabseq
