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

template <int Width>
ElementModes::Modes<Width> ChunkModes::modes_at(std::size_t element, std::span<const double> values,
                                                int lanes, int first) const {
  ElementModes::Nodal<Width> u;
  for (int corner = 0; corner < 8; ++corner) {
    const std::size_t node =
        positions_[model_.domain.first_corners[element] + model_.part.grid().corner_offsets()[corner]];
    for (int a = 0; a < 3; ++a) u[a][corner] = Lanes<Width>::load(&values[(node * 3 + a) * lanes + first]);
  }
  return modes_.of<Width>(u);
}

template <int Width>
void ChunkModes::add_at(std::size_t element, const ElementModes::Modes<Width>& modes,
                        std::span<double> forces, int lanes, int first) const {
  const auto f = modes_.forces<Width>(modes);
  for (int corner = 0; corner < 8; ++corner) {
    const std::size_t node =
        model_.domain.first_corners[element] + model_.part.grid().corner_offsets()[corner];
    for (int a = 0; a < 3; ++a) {
      double* place = &forces[(node * 3 + a) * lanes + first];
      (Lanes<Width>::load(place) + f[a][corner]).store(place);
    }
  }
}

void ChunkModes::set_block(const PlasticBatches::Chunk& chunk, std::span<const double> values, int lanes,
                           std::vector<double>& modes) const {
  modes.resize((chunk.end - chunk.begin) * components * lanes);
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
      const auto of_element = modes_at<Width>(e, values, lanes, first);
      for (int c = 0; c < components; ++c)
        of_element[c].store(&modes[((e - chunk.begin) * components + c) * lanes + first]);
    }
  });
}

void ChunkModes::set_histories(const PlasticBatches::Chunk& chunk, std::span<const double> values, int lanes,
                               std::vector<double>& histories) const {
  const std::size_t of_batch = static_cast<std::size_t>(lanes) * step_size;
  histories.resize(chunk.batches() * of_batch);
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    Batch<Width> batch;
    for_each_batch(chunk, [&](std::size_t element, std::size_t count, std::size_t number) {
      for (std::size_t e = 0; e < count; ++e) batch[e] = modes_at<Width>(element + e, values, lanes, first);
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

void ChunkModes::add_block(const PlasticBatches::Chunk& chunk, std::span<const double> modes, int lanes,
                           std::span<double> forces) const {
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
      ElementModes::Modes<Width> of_element;
      for (int c = 0; c < components; ++c)
        of_element[c] = Lanes<Width>::load(&modes[((e - chunk.begin) * components + c) * lanes + first]);
      add_at<Width>(e, of_element, forces, lanes, first);
    }
  });
}

void ChunkModes::add_histories(const PlasticBatches::Chunk& chunk, std::span<const double> histories,
                               int lanes, std::span<double> forces) const {
  const std::size_t of_batch = static_cast<std::size_t>(lanes) * step_size;
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    Batch<Width> batch;
    for_each_batch(chunk, [&](std::size_t element, std::size_t count, std::size_t number) {
      load<Width>(&histories[number * of_batch], first, batch);
      for (std::size_t e = 0; e < count; ++e) add_at<Width>(element + e, batch[e], forces, lanes, first);
    });
  });
}

void ChunkModes::end_forces(const std::vector<double>& ghosted, LaneVector& forces) const {
  if (!one_rank_) model_.part.grid().exchange(3 * forces.lanes).add_to_owned(ghosted, forces.values);
}

}  // namespace fabseq
