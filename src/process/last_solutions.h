// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/parallel/step_dealing.h"

#include <cstddef>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace fabseq {

/// The solutions of a group's blocks for each of their right-hand sides, in single precision: what the next
/// solves begin with. Local.
class LastSolutions {
 public:
  /// Names the solution of a block for a right-hand side, by its number. `adjoint`: whether of an adjoint.
  struct Place {
    bool adjoint = false;
    StepBlock block;
    std::size_t side = 0;
  };

  /// Sets `solution`, of its size, to what was kept there of these nodes, or to zero.
  void recall(const Place& place, std::span<const int> nodes, LaneVector& solution) const;
  void keep(const Place& place, std::span<const int> nodes, const LaneVector& solution);
  void forget() { solutions_.clear(); }

 private:
  using Key = std::tuple<bool, int, std::size_t>;
  static Key key(const Place& place) { return {place.adjoint, place.block.first, place.side}; }

  std::map<Key, std::vector<float>> solutions_;  ///< by the first step of a block
};

}  // namespace fabseq
