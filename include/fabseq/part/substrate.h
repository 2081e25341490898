// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/part/pieces.h"
#include "fabseq/part/shape.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace fabseq {

/// Elements that stand from the start and are not built, such as a base plate (docs/formulation.md 4.4).
/// There may be none.
template <int Dim>
class Substrate {
 public:
  /// The elements whose centres lie in `shape`, of which no reference is kept. Collective on the grid's
  /// communicator. The grid must outlive the object. Throws InputError if a shape is given that holds no
  /// element.
  Substrate(const Grid<Dim>& grid, const std::optional<Shape>& shape);

  /// Number of elements, summed over all ranks.
  std::int64_t count() const { return count_; }
  /// 1 for the owned elements of the grid that belong to the substrate, lexicographic in
  /// Grid::owned_elements().
  const std::vector<char>& elements() const { return elements_; }
  /// 1 for the owned nodes of such elements, which may be on any rank, lexicographic in Grid::owned_nodes().
  const std::vector<char>& nodes() const { return nodes_; }
  /// 1 for the substrate's owned nodes on its side towards the plate: the lowest ones along the plate's
  /// normal. Collective on the grid's communicator.
  std::vector<char> nodes_towards(const BuildPlate& plate) const;
  /// Returns half the spacing across the face that each owned element shares with the substrate, the smallest
  /// one if there are several; infinite without such a face. Length unit. Collective on the grid's
  /// communicator.
  std::vector<double> contact_distance() const;

 private:
  const Grid<Dim>& grid_;
  std::vector<char> elements_, nodes_;
  std::int64_t count_ = 0;
};

/// 1 for the owned nodes of these elements, offsets in Grid::owned_elements(); those of all ranks count.
/// Collective on the grid's communicator.
template <int Dim>
std::vector<char> nodes_of_elements(const Grid<Dim>& grid, const std::vector<int>& elements);

}  // namespace fabseq
