// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/parallel/step_transpose.h"
#include "fabseq/process/elastic_model.h"
#include "process/chunk_modes.h"
#include "process/element_modes.h"
#include "process/plastic_batches.h"
#include "process/plastic_wave.h"

#include <cstddef>
#include <functional>
#include <optional>
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
  PlasticExchange(const ElasticModel<3>& model, const LayerGroups& groups, const PlasticBatches& batches);

  /// Takes the wave whose steps run() goes through. Local.
  void set_wave(const PlasticWave& wave);
  /// What is done with a chunk: histories of the fields, and forces to be set (ElementModes::forces()).
  using Work =
      std::function<void(const PlasticBatches::Chunk& chunk, std::span<const std::vector<double>> histories,
                         std::vector<double>& forces)>;
  /// Calls `work` for one chunk after the other. `forces`: sum over the elements; nullptr: none are asked
  /// for, and `work` need not set them.
  void run(std::span<const LaneVector* const> fields, LaneVector* forces, const Work& work) const;
  const ElementModes& modes() const { return nodes_.modes(); }
  const PlasticBatches& batches() const { return batches_; }
  /// Gives back what is kept from call to call; set_wave() comes before the next one. Local.
  void release_memory();

 private:
  NodeHistories<const double> values_of(const LaneVector& field, std::size_t number) const;
  NodeHistories<double> zero_forces(std::span<double> own) const;

  const LayerGroups& groups_;
  const PlasticBatches& batches_;
  ChunkModes nodes_;
  std::vector<StepTranspose::Range> value_nodes_, force_nodes_;  ///< [group] around its share of the elements
  PlasticWave wave_;
  std::optional<StepTranspose> value_transpose_, force_transpose_;            ///< only with several groups
  mutable std::vector<std::vector<double>> ghosted_, all_steps_, histories_;  ///< scratch, [field]
  mutable std::vector<double> ghosted_forces_, forces_of_all_steps_, forces_of_chunk_;  ///< scratch
};

}  // namespace fabseq
