// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/parallel/step_transpose.h"
#include "fabseq/process/elastic_model.h"
#include "process/element_modes.h"
#include "process/plastic_batches.h"

#include <span>
#include <vector>

namespace fabseq {

/// Values of the nodes from `first` on, in all steps of a wave: [node][component][step].
template <class Value>
struct NodeHistories {
  std::span<Value> values;
  std::size_t first = 0;
  int steps = 0;
};

/// Histories of a chunk's elements, [batch][step][ElementModes][element of the batch], from displacements of
/// the nodes, and nodal forces from histories. Local, unless a call says otherwise.
class ChunkModes {
 public:
  /// The model must outlive the object.
  explicit ChunkModes(const ElasticModel<3>& model);
  const ElementModes& modes() const { return modes_; }
  /// The least range that holds the nodes around elements `begin` .. `end` - 1, as values() and
  /// begin_forces() number them.
  StepTranspose::Range value_nodes(std::size_t begin, std::size_t end) const;
  StepTranspose::Range force_nodes(std::size_t begin, std::size_t end) const;

  /// Values of displacements on the model's nodes: those themselves, or, where the grid has several ranks,
  /// `ghosted`, which is set. Collective on the grid's communicator.
  std::span<const double> values(const LaneVector& displacements, std::vector<double>& ghosted) const;
  /// `nodes` are numbered as by value_nodes(). Elements that are missing in the last batch do not move.
  void set_histories(const PlasticBatches::Chunk& chunk, const NodeHistories<const double>& nodes,
                     std::vector<double>& histories) const;

  /// Begins a sum of forces on all owned nodes. Returns zeros, to which forces are added: the values of
  /// `forces`, or `ghosted` where the grid has several ranks.
  std::span<double> begin_forces(int lanes, LaneVector& forces, std::vector<double>& ghosted) const;
  /// Adds the forces to `nodes`, which are numbered as by force_nodes().
  void add_histories(const PlasticBatches::Chunk& chunk, std::span<const double> histories,
                     const NodeHistories<double>& nodes) const;
  /// Ends it. Collective on the grid's communicator.
  void end_forces(const std::vector<double>& ghosted, LaneVector& forces) const;

 private:
  template <int Width>
  ElementModes::Modes<Width> modes_at(std::size_t element, const NodeHistories<const double>& nodes,
                                      int step) const;
  template <int Width>
  void add_at(std::size_t element, const ElementModes::Modes<Width>& modes,
              const NodeHistories<double>& nodes, int step) const;
  /// The range of numbers that number_of(node of the ghosted box) gives around elements.
  template <class Function>
  StepTranspose::Range nodes_around(std::size_t begin, std::size_t end, Function&& number_of) const;
  /// Node of a corner of an element in the ghosted box.
  std::size_t corner(std::size_t element, int corner) const {
    return model_.domain.first_corners[element] + model_.part.grid().corner_offsets()[corner];
  }

  const ElasticModel<3>& model_;
  ElementModes modes_;
  bool one_rank_;
  std::vector<int> positions_;  ///< in the values, of each node of the ghosted box
};

}  // namespace fabseq
