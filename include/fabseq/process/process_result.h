// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/parallel/layer_dealing.h"

#include <mpi.h>

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Adds factor * from to a vector of the same length, or to an empty one.
void add_scaled(std::vector<double>& to, double factor, const std::vector<double>& from);

/// Displacements that one strain leads to, on this rank's nodes, length unit.
struct CaseDisplacements {
  std::vector<LaneVector> increments;  ///< of the layers of this rank's group, by block, on
                                       ///< ProcessResult::nodes: [node][component][lane]
  std::vector<double> displacement;    ///< u, all layers' sum, [owned node][component]
  std::vector<double> release;         ///< v, what the release adds to u; empty if that is not asked for
};

/// What a simulated process leads to, with the strain as given and with the other cases of StrainCases.
struct ProcessResult : CaseDisplacements {
  MPI_Comm all_layers = MPI_COMM_NULL;      ///< the ranks that together have the increments of all layers
  std::vector<LayerBlock> blocks;           ///< the layers of this rank's group
  std::vector<std::span<const int>> nodes;  ///< by block: this rank's nodes that have increments, ascending;
                                            ///< valid until the next simulation
  std::vector<LaneVector> weights;  ///< share of increments that counts (Deposition), [one of the block's
                                    ///< `nodes`][lane]; empty: all
  std::vector<int> iterations;      ///< of each layer's solve, all layers; of all cases the largest
  std::vector<CaseDisplacements> other_cases;
  std::vector<std::vector<double>> scenarios;  ///< combinations of the cases, StrainCases::scenarios

  /// What counts of the increment of an unknown (node * components + component) in a layer of a block.
  double counted(std::size_t block, std::size_t unknown, int lane) const {
    const LaneVector& increment = increments[block];
    if (weights.empty()) return increment(unknown, lane);
    return weights[block](unknown / increment.components, lane) * increment(unknown, lane);
  }
  /// Where an unknown of the increments of a block is in fields of all owned nodes.
  std::size_t in_field(std::size_t block, std::size_t unknown, int components) const {
    return static_cast<std::size_t>(nodes[block][unknown / components]) * components + unknown % components;
  }
  /// Adds what counts of the increments of a block to the displacement, both of one case.
  void add_counted(std::size_t block, CaseDisplacements& of) const;
  std::size_t case_count() const { return other_cases.size() + 1; }
  CaseDisplacements& of_case(std::size_t number) { return number == 0 ? *this : other_cases[number - 1]; }
  const CaseDisplacements& of_case(std::size_t number) const {
    return number == 0 ? *this : other_cases[number - 1];
  }
  /// The result for a combination of the cases, which has no other cases; increments, which take memory, only
  /// if asked for.
  ProcessResult combined(std::span<const double> combination, bool with_increments) const;
  /// The result of a process that leads to a displacement at once: it has no increments, other cases or
  /// release.
  ProcessResult at_once(std::vector<double> displacement) const;
  /// Increments of a block for a combination of the cases.
  LaneVector combined_increments(std::span<const double> combination, std::size_t block) const;
};

}  // namespace fabseq
