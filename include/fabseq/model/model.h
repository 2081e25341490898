// SPDX-License-Identifier: MIT
/// \file
/// What does not change during a run: grid, part, kinds of layers, places of the design variables, node sets.
#pragma once

#include "fabseq/files/design_layout.h"
#include "fabseq/layers/layer_model.h"
#include "fabseq/model/model_settings.h"
#include "fabseq/model/placed_part.h"
#include "fabseq/model/run_cost.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/part/node_set.h"
#include "fabseq/part/part.h"
#include "fabseq/part/supports.h"
#include "fabseq/responses/response.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/sequence/sequence_kind.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Made of settings, with what "auto" stands for. Collective construction on the world of the run; every
/// layer group has the same grid, part and node sets on its ranks. The settings must outlive the model, which
/// cannot be copied or moved, since its members refer to each other. Throws InputError for anything wrong
/// with part, plate, substrate, clamps, start region or node sets.
template <int Dim>
class Model {
 public:
  Model(MPI_Comm world, const ModelSettings& settings_);
  Model(Model&&) = delete;

  const ModelSettings& settings;

 private:
  std::unique_ptr<PlacedPart<Dim>> placed_;

 public:
  const GroupChoice& group_choice;
  const LayerGroups& groups;
  Grid<Dim>& grid;
  Part<Dim>& part;
  Supports<Dim> supports;
  const SequenceSettings& sequence_settings;  ///< with the lengths that follow from the part
  const std::optional<StartRegion>& start;    ///< of sequences that begin in a region
  const DesignSupport<Dim>& design_support;   ///< where the sequence has variables
  const std::map<std::string, NodeSet>& node_sets;
  const LayerModel<Dim>* layers;                    ///< of the design
  std::unique_ptr<const LayerModel<Dim>> baseline;  ///< of the planar sequence it is compared with
  const ResponseList<Dim>&objective, &constraints;  ///< their terms
  const RunSize& size;
  int lanes;                     ///< layers solved side by side at most
  double characteristic_length;  ///< l_c, length unit
  SolverSettings solver;         ///< with the region of an optimization's iterations

  /// All ranks of the run; the grid has a communicator of its own.
  MPI_Comm world() const { return groups.world(); }
  BlockSolver block_solver() const { return fabseq::block_solver(settings.solver.path); }
  /// A design's field, or anything else of which this rank has its share, on the owned elements or nodes.
  /// Collective.
  std::vector<double> design_field(std::span<const double> share) const {
    return design_support.expand(groups.gather(share));
  }
  /// Bounds and scales of the variables of which this rank has its share.
  DesignSpace space_of_share(const Sequence<Dim>& sequence) const {
    return sequence.space().from(groups.first_of_share(sequence.variables()));
  }
  /// The same, and back, for files.
  DesignLayout<Dim> design_layout() const;
  ResponseContext<Dim> context() const { return placed_->context(); }
};

}  // namespace fabseq
