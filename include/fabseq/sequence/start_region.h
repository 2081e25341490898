// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence_settings.h"

#include <vector>

namespace fabseq {

/// The start region of a direct sequence (docs/formulation.md 2.3) on this rank: its pseudo-time is 0, all
/// else of the part is free.
struct StartRegion {
  std::vector<char> elements;  ///< part field: 1 where t_e is 0 whatever the design
  std::vector<int> free;  ///< elements or nodes with a variable: offsets in the grid's owned ones, ascending
  std::vector<double> initial_time;  ///< of these: distance from the region in the part, over the largest
};

/// With variables on elements: the elements whose centres lie in the shape; if it holds none, those with a
/// node in or on it. With variables on nodes: the nodes in or on it, and those of the substrate; elements all
/// of whose nodes are. Without a shape: what has a face, or lies, on the build plate or the substrate.
/// Collective on the grid's communicator. Throws InputError if the shape meets nothing of the part or holds
/// all of it, or if not all of the part can be reached from it.
template <int Dim>
StartRegion make_start_region(const Part<Dim>& part, const SequenceSettings& settings);

}  // namespace fabseq
