// SPDX-License-Identifier: MIT
/// \file
/// Stiff blocks in soft surroundings.
#pragma once

#include "fabseq/grid/index_box.h"

#include <array>
#include <vector>

namespace fabseq::test {

constexpr double soft = 1e-6;

/// Blocks of stiffness 1 over a soft grid, the lowest layer along the last axis stiff, too: it is what stands
/// on the plate.
template <int Dim>
struct Islands {
  Index<Dim> elements;
  std::vector<IndexBox<Dim>> blocks;

  double stiffness(const Index<Dim>& element) const {
    if (element[Dim - 1] == 0) return 1.0;
    for (const auto& block : blocks)
      if (block.contains(element)) return 1.0;
    return soft;
  }
  std::vector<double> field() const {
    std::vector<double> result;
    IndexBox<Dim>{{}, elements}.for_each(
        [&](const Index<Dim>& element, std::int64_t) { result.push_back(stiffness(element)); });
    return result;
  }
  /// Whether an element stands on the plate.
  std::vector<char> supported() const {
    std::vector<char> result;
    IndexBox<Dim>{{}, elements}.for_each(
        [&](const Index<Dim>& element, std::int64_t) { result.push_back(element[Dim - 1] == 0 ? 1 : 0); });
    return result;
  }
  /// Block that a node is a corner of; -1: none.
  int block_at(const Index<Dim>& node) const {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      IndexBox<Dim> corners = blocks[i];
      for (int& extent : corners.size) ++extent;
      if (corners.contains(node)) return static_cast<int>(i);
    }
    return -1;
  }
};

/// Two islands, the larger one first.
template <int Dim>
Islands<Dim> two_islands() {
  if constexpr (Dim == 2)
    return {{30, 27}, {{{3, 8}, {9, 11}}, {{17, 14}, {7, 6}}}};
  else
    return {{14, 9, 12}, {{{2, 2, 4}, {5, 4, 6}}, {{9, 3, 6}, {3, 4, 3}}}};
}

}  // namespace fabseq::test
