// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/parallel/step_dealing.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/standing_elements.h"

#include <span>
#include <vector>

namespace fabseq {

/// A block of steps with the elements that its solves take into account.
struct BlockRegion {
  StepBlock block;
  std::vector<BuildStep> steps;     ///< those of the block
  std::vector<char> elements = {};  ///< whether each element of the model is in; empty: all are
  std::vector<int> nodes = {};  ///< of this rank, ascending: those at the elements; not set where all are in

  int layer(int lane) const { return steps[lane].layer; }
  bool has(std::size_t model_element) const { return elements.empty() || elements[model_element] != 0; }
};

/// The elements of a model without void that a block of steps stands on (docs/formulation.md 4.8): those
/// that stand, and their neighbours, corner neighbours included. The seam of neighbours keeps two stiff
/// elements that touch in an edge or a corner from being a hinge.
template <int Dim>
class BuiltRegion {
 public:
  /// The model must outlive the object. Collective on the grid's communicator.
  explicit BuiltRegion(const ElasticModel<Dim>& model);

  /// The region of a block of steps: all elements where a piece of it would have none with a face on a
  /// support, since nothing would hold that piece. Collective on the grid's communicator.
  BlockRegion of(const LayerDensities& densities, const StepBlock& block,
                 std::span<const BuildStep> steps) const;
  /// Share of the model's elements, of all ranks, that stand in each layer's eight. Collective on the grid's
  /// communicator.
  std::vector<double> standing_shares(const LayerDensities& densities) const;

 private:
  bool is_held(const std::vector<double>& region) const;

  const ElasticModel<Dim>& model_;
  StandingElements<Dim> standing_;
  std::vector<int> held_;  ///< elements with a face whose nodes are all held, in Grid::owned_elements()
};

}  // namespace fabseq
