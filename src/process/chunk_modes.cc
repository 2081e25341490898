// SPDX-License-Identifier: MIT
#include "process/chunk_modes.h"

#include "fabseq/base/mpi.h"
#include "process/plastic_point.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace fabseq {

namespace {

constexpr int components = ElementModes::components;
constexpr int step_size = components * plastic_width;

/// Modes of a batch, [element], in steps side by side.
template <int Width>
using Batch = std::array<ElementModes::Modes<Width>, plastic_width>;

/// Sets the histories of the steps from `first` on.
template <int Width>
void store(const Batch<Width>& batch, int first, double* histories) {
  for (int c = 0; c < components; ++c)
    if constexpr (Width == plastic_width) {
      std::array<Lanes<Width>, plastic_width> elements;
      for (int e = 0; e < plastic_width; ++e) elements[e] = batch[e][c];
      const auto steps = transposed<Width>(elements);
      for (int s = 0; s < Width; ++s) steps[s].store(&histories[(first + s) * step_size + c * plastic_width]);
    } else {
      for (int e = 0; e < plastic_width; ++e)
        for (int s = 0; s < Width; ++s)
          histories[(first + s) * step_size + c * plastic_width + e] = batch[e][c][s];
    }
}

/// The other way round.
template <int Width>
void load(const double* histories, int first, Batch<Width>& batch) {
  for (int c = 0; c < components; ++c)
    if constexpr (Width == plastic_width) {
      std::array<Lanes<Width>, plastic_width> steps;
      for (int s = 0; s < Width; ++s)
        steps[s] = Lanes<Width>::load(&histories[(first + s) * step_size + c * plastic_width]);
      const auto elements = transposed<Width>(steps);
      for (int e = 0; e < plastic_width; ++e) batch[e][c] = elements[e];
    } else {
      std::array<double, Width> of_element;
      for (int e = 0; e < plastic_width; ++e) {
        for (int s = 0; s < Width; ++s)
          of_element[s] = histories[(first + s) * step_size + c * plastic_width + e];
        batch[e][c] = Lanes<Width>::load(of_element.data());
      }
    }
}

/// Calls f(first element, number of elements, number of the batch in the chunk).
template <class Function>
void for_each_batch(const PlasticBatches::Chunk& chunk, Function&& f) {
  for (std::size_t b = 0; b < chunk.batches(); ++b) {
    const std::size_t first = b * plastic_width;
    f(chunk.first + first, std::min<std::size_t>(plastic_width, chunk.count - first), b);
  }
}

}  // namespace

ChunkModes::ChunkModes(const ElasticModel<3>& model)
    : model_(model),
      modes_(model.element, model.part.grid().spacing()),
      one_rank_(size_of(model.part.grid().comm()) == 1),
      positions_(static_cast<std::size_t>(model.part.grid().ghosted_nodes().count())) {
  std::iota(positions_.begin(), positions_.end(), 0);
  if (!one_rank_) return;
  for (std::size_t k = 0; k < model.nodes.size(); ++k) positions_[model.nodes[k]] = static_cast<int>(k);
}

std::span<const double> ChunkModes::values(const LaneVector& displacements,
                                           std::vector<double>& ghosted) const {
  if (one_rank_) return displacements.values;
  const Grid<3>& grid = model_.part.grid();
  LaneVector owned;
  spread(displacements, model_.nodes, static_cast<int>(grid.owned_nodes().count()), owned);
  ghosted.resize(positions_.size() * 3 * displacements.lanes);
  grid.exchange(3 * displacements.lanes).to_ghosted(owned.values, ghosted);
  return ghosted;
}

template <class Function>
StepTranspose::Range ChunkModes::nodes_around(std::size_t begin, std::size_t end,
                                              Function&& number_of) const {
  StepTranspose::Range result;
  for (std::size_t e = begin; e < end; ++e)
    for (int c = 0; c < 8; ++c) {
      const std::size_t number = number_of(corner(e, c));
      result.begin = result.end == 0 ? number : std::min(result.begin, number);
      result.end = std::max(result.end, number + 1);
    }
  return result;
}

StepTranspose::Range ChunkModes::value_nodes(std::size_t begin, std::size_t end) const {
  return nodes_around(begin, end, [this](std::size_t node) { return positions_[node]; });
}

StepTranspose::Range ChunkModes::force_nodes(std::size_t begin, std::size_t end) const {
  return nodes_around(begin, end, [](std::size_t node) { return node; });
}

template <int Width>
ElementModes::Modes<Width> ChunkModes::modes_at(std::size_t element, const NodeHistories<const double>& nodes,
                                                int step) const {
  ElementModes::Nodal<Width> u;
  for (int c = 0; c < 8; ++c) {
    const std::size_t node = positions_[corner(element, c)] - nodes.first;
    for (int a = 0; a < 3; ++a)
      u[a][c] = Lanes<Width>::load(&nodes.values[(node * 3 + a) * nodes.steps + step]);
  }
  return modes_.of<Width>(u);
}

template <int Width>
void ChunkModes::add_at(std::size_t element, const ElementModes::Modes<Width>& modes,
                        const NodeHistories<double>& nodes, int step) const {
  const auto f = modes_.forces<Width>(modes);
  for (int c = 0; c < 8; ++c) {
    const std::size_t node = corner(element, c) - nodes.first;
    for (int a = 0; a < 3; ++a) {
      double* place = &nodes.values[(node * 3 + a) * nodes.steps + step];
      (Lanes<Width>::load(place) + f[a][c]).store(place);
    }
  }
}

void ChunkModes::set_histories(const PlasticBatches::Chunk& chunk, const NodeHistories<const double>& nodes,
                               std::vector<double>& histories) const {
  const std::size_t of_batch = static_cast<std::size_t>(nodes.steps) * step_size;
  histories.resize(chunk.batches() * of_batch);
  for_lane_chunks(nodes.steps, [&]<int Width>(int first) {
    Batch<Width> batch;
    for_each_batch(chunk, [&](std::size_t element, std::size_t count, std::size_t number) {
      for (std::size_t e = 0; e < count; ++e) batch[e] = modes_at<Width>(element + e, nodes, first);
      for (std::size_t e = count; e < plastic_width; ++e) batch[e].fill(Lanes<Width>::zero());
      store<Width>(batch, first, &histories[number * of_batch]);
    });
  });
}

std::span<double> ChunkModes::begin_forces(int lanes, LaneVector& forces,
                                           std::vector<double>& ghosted) const {
  resize(forces, static_cast<int>(model_.part.grid().owned_nodes().count()), 3, lanes);
  if (one_rank_) {
    std::ranges::fill(forces.values, 0.0);
    return forces.values;
  }
  ghosted.assign(positions_.size() * 3 * lanes, 0.0);
  return ghosted;
}

void ChunkModes::add_histories(const PlasticBatches::Chunk& chunk, std::span<const double> histories,
                               const NodeHistories<double>& nodes) const {
  const std::size_t of_batch = static_cast<std::size_t>(nodes.steps) * step_size;
  for_lane_chunks(nodes.steps, [&]<int Width>(int first) {
    Batch<Width> batch;
    for_each_batch(chunk, [&](std::size_t element, std::size_t count, std::size_t number) {
      load<Width>(&histories[number * of_batch], first, batch);
      for (std::size_t e = 0; e < count; ++e) add_at<Width>(element + e, batch[e], nodes, first);
    });
  });
}

void ChunkModes::end_forces(const std::vector<double>& ghosted, LaneVector& forces) const {
  if (!one_rank_) model_.part.grid().exchange(3 * forces.lanes).add_to_owned(ghosted, forces.values);
}

}  // namespace fabseq
