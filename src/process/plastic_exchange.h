// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/process/elastic_model.h"
#include "process/element_modes.h"
#include "process/plastic_batches.h"
#include "process/plastic_wave.h"

#include <functional>
#include <span>
#include <vector>

namespace fabseq {

/// Displacements of the steps of a wave to the histories of elements, and forces back to the steps:
/// displacements are on the model's nodes, forces on all owned ones, with the steps of this group's block in
/// lanes; histories are of this rank's share of the elements, [batch of the chunk][step of the
/// wave][ElementModes][element of the batch]. Collective on the world of the groups.
class PlasticExchange {
 public:
  /// All arguments must outlive the object.
  PlasticExchange(const ElasticModel<3>& model, const LayerGroups& groups, const PlasticBatches& batches)
      : model_(model),
        groups_(groups),
        batches_(batches),
        modes_(model.element, model.part.grid().spacing()) {}

  /// What is done with a chunk: histories of the fields, and forces to be set (ElementModes::forces()).
  using Work =
      std::function<void(const PlasticBatches::Chunk& chunk, std::span<const std::vector<double>> histories,
                         std::vector<double>& forces)>;
  /// Calls `work` for one chunk after the other. `forces`: sum over the elements; nullptr: none are asked
  /// for, and `work` need not set them.
  void run(const PlasticWave& wave, std::span<const LaneVector* const> fields, LaneVector* forces,
           const Work& work) const;
  const ElementModes& modes() const { return modes_; }
  const PlasticBatches& batches() const { return batches_; }

 private:
  void set_modes(const PlasticBatches::Chunk& chunk, std::span<const double> ghosted, int lanes,
                 std::vector<double>& modes) const;
  void add_forces(const PlasticBatches::Chunk& chunk, std::span<const double> modes, int lanes,
                  std::span<double> ghosted) const;

  const ElasticModel<3>& model_;
  const LayerGroups& groups_;
  const PlasticBatches& batches_;
  ElementModes modes_;
  mutable std::vector<std::vector<double>>
      histories_;  ///< scratch of one chunk after the other, as are these
  mutable std::vector<double> forces_of_chunk_, values_;
};

}  // namespace fabseq
