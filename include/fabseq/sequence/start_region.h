// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"
#include "fabseq/part/shape.h"

#include <optional>
#include <vector>

namespace fabseq {

/// Where the variables of a direct sequence are.
enum class DesignLocation { elements, nodes };

/// This rank's share of the start region of a direct sequence (docs/formulation.md 2.3). The pseudo-time is 0
/// in the region and free in the rest of the part.
struct StartRegion {
  std::vector<char> elements;  ///< part field: 1 if t_e is 0 whatever the design
  std::vector<int> free;       ///< elements or nodes with a variable: offsets in the owned ones, ascending
  std::vector<double> initial_time;  ///< [entry of free]: distance from the region over the largest distance
};

/// Makes the start region of a shape or, without one, of all that has a face or lies on the build plate or
/// the substrate.
/// - With variables on elements, it consists of the elements whose centres lie in the shape or, if there are
/// none, of those with a node in or on it.
/// - With variables on nodes, it consists of the nodes in or on the shape and those of the substrate, and of
/// the elements all of whose nodes belong to it.
///
/// Collective on the grid's communicator. Throws InputError if the shape meets nothing of the part or holds
/// all of it, or if some of the part cannot be reached from it.
template <int Dim>
StartRegion make_start_region(const Part<Dim>& part, DesignLocation location,
                              const std::optional<Shape>& shape);

}  // namespace fabseq
