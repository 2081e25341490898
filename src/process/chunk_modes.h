// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/process/elastic_model.h"
#include "process/element_modes.h"
#include "process/plastic_batches.h"

#include <span>
#include <vector>

namespace fabseq {

/// Modes of a chunk's elements from the displacements of a block of steps, and nodal forces from modes. A
/// *block* has modes as [element][ElementModes][step]. *Histories* have them as [batch][step][ElementModes]
/// [element of the batch]; they need a rank that finds the histories of all its elements itself. Local,
/// unless a call says otherwise.
class ChunkModes {
 public:
  /// The model must outlive the object.
  explicit ChunkModes(const ElasticModel<3>& model);
  const ElementModes& modes() const { return modes_; }

  /// Values of displacements on the model's nodes as the calls below take them: those themselves, or, where
  /// the grid has several ranks, `ghosted`, which is set. Collective on the grid's communicator.
  std::span<const double> values(const LaneVector& displacements, std::vector<double>& ghosted) const;
  void set_block(const PlasticBatches::Chunk& chunk, std::span<const double> values, int lanes,
                 std::vector<double>& modes) const;
  /// Elements that are missing in the last batch do not move.
  void set_histories(const PlasticBatches::Chunk& chunk, std::span<const double> values, int lanes,
                     std::vector<double>& histories) const;

  /// Begins a sum of forces on all owned nodes. Returns zeros, to which add_block() and add_histories() add:
  /// the values of `forces`, or `ghosted` where the grid has several ranks.
  std::span<double> begin_forces(int lanes, LaneVector& forces, std::vector<double>& ghosted) const;
  void add_block(const PlasticBatches::Chunk& chunk, std::span<const double> modes, int lanes,
                 std::span<double> forces) const;
  void add_histories(const PlasticBatches::Chunk& chunk, std::span<const double> histories, int lanes,
                     std::span<double> forces) const;
  /// Ends it. Collective on the grid's communicator.
  void end_forces(const std::vector<double>& ghosted, LaneVector& forces) const;

 private:
  template <int Width>
  ElementModes::Modes<Width> modes_at(std::size_t element, std::span<const double> values, int lanes,
                                      int first) const;
  template <int Width>
  void add_at(std::size_t element, const ElementModes::Modes<Width>& modes, std::span<double> forces,
              int lanes, int first) const;

  const ElasticModel<3>& model_;
  ElementModes modes_;
  bool one_rank_;
  std::vector<int> positions_;  ///< in the values, of each node of the ghosted box
};

}  // namespace fabseq
