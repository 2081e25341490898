// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/parallel/step_dealing.h"
#include "fabseq/process/build_step.h"

#include <mpi.h>

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Adds factor * from to a vector of the same length, or to an empty one.
void add_scaled(std::vector<double>& to, double factor, const std::vector<double>& from);

/// Displacements that one strain leads to, on this rank's nodes, length unit.
struct CaseDisplacements {
  std::vector<LaneVector> increments;  ///< of the steps of this rank's group, by block, on
                                       ///< ProcessResult::nodes: [node][component][lane]
  std::vector<double> displacement;    ///< u, all steps' sum, [owned node][component]
  std::vector<double> release;         ///< v, what the release adds to u; empty if that is not asked for
};

class Superposition;

/// What a simulated process leads to, with the strain as given and, where it is linear in the strain, with
/// the other cases of its superposition.
struct ProcessResult : CaseDisplacements {
  MPI_Comm all_layers = MPI_COMM_NULL;      ///< the ranks that together have the increments of all steps
  std::vector<BuildStep> steps;             ///< all; a block has all of a layer
  std::vector<StepBlock> blocks;            ///< the steps of this rank's group
  std::vector<std::span<const int>> nodes;  ///< by block: this rank's nodes that have increments, ascending;
                                            ///< valid until the next simulation
  std::vector<LaneVector> weights;  ///< share of increments that counts (Deposition), [one of the block's
                                    ///< `nodes`][lane]; empty: all
  std::vector<int> iterations;      ///< of each step's solve, all steps; of all cases the largest
  std::vector<CaseDisplacements> other_cases;
  const Superposition* superposition = nullptr;  ///< of the cases; null: the process is not linear

  /// Whether displacements are linear in the strain.
  bool linear() const { return superposition != nullptr; }
  /// The steps of a block.
  std::span<const BuildStep> steps_of(std::size_t block) const {
    return std::span(steps).subspan(blocks[block].first, blocks[block].lanes);
  }
  /// What counts of the increment of an unknown (node * components + component) in a step of a block.
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
};

}  // namespace fabseq
