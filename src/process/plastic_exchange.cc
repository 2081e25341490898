// SPDX-License-Identifier: MIT
#include "process/plastic_exchange.h"

#include "fabseq/parallel/step_transpose.h"
#include "process/plastic_point.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace fabseq {

namespace {

constexpr int components = ElementModes::components;

/// Calls f(entry of a block's values, entry of the batches' values) for all that they have in common: blocks
/// are [element][component][lane], histories as StepTranspose has them are blocks with components as lanes.
template <class Function>
void for_each_place(std::size_t elements, int steps, int element_stride, int component_stride,
                    int step_stride, Function&& f) {
  for (std::size_t e = 0; e < elements; ++e) {
    const std::size_t from = e * element_stride,
                      to = e / plastic_width * steps * components * plastic_width + e % plastic_width;
    for (int c = 0; c < components; ++c)
      for (int s = 0; s < steps; ++s)
        f(from + c * component_stride + s * step_stride, to + (s * components + c) * plastic_width);
  }
}

}  // namespace

void PlasticExchange::run(const PlasticWave& wave, std::span<const LaneVector* const> fields,
                          LaneVector* forces, const Work& work) const {
  const Grid<3>& grid = model_.part.grid();
  const int lanes = wave.lanes(groups_.index());
  const bool alone = groups_.count() == 1;
  const std::size_t ghosted_size = static_cast<std::size_t>(grid.ghosted_nodes().count()) * 3 * lanes;
  std::vector<std::vector<double>> ghosted(fields.size());
  for (std::size_t k = 0; lanes > 0 && k < fields.size(); ++k) {
    LaneVector all;
    spread(*fields[k], model_.nodes, static_cast<int>(grid.owned_nodes().count()), all);
    ghosted[k] = grid.exchange(3 * lanes).ghosted(all.values);
  }
  std::vector<double> ghosted_forces;
  if (forces != nullptr) ghosted_forces.resize(ghosted_size, 0.0);
  std::vector<std::vector<double>> blocks(lanes > 0 ? 1 : 0);
  histories_.resize(fields.size());
  for (const PlasticBatches::Chunk& chunk : batches_.chunks()) {
    std::optional<StepTranspose> transpose;
    if (!alone) transpose.emplace(groups_, wave.deal, chunk.end - chunk.begin, components);
    const std::size_t size = chunk.batches() * wave.count * components * plastic_width;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (lanes > 0) set_modes(chunk, ghosted[k], lanes, blocks.front());
      histories_[k].resize(size);
      // Elements that are not there do not move.
      if (chunk.count % plastic_width != 0) std::ranges::fill(histories_[k], 0.0);
      const auto copy = [&](const std::vector<double>& values) {
        return [&values, &to = histories_[k]](std::size_t from, std::size_t at) { to[at] = values[from]; };
      };
      if (alone)
        for_each_place(chunk.count, lanes, components * lanes, lanes, 1, copy(blocks.front()));
      else
        for_each_place(chunk.count, wave.count, components * wave.count, 1, components,
                       copy(transpose->to_histories(blocks)));
    }
    if (forces != nullptr) forces_of_chunk_.resize(size);
    work(chunk, histories_, forces_of_chunk_);
    if (forces == nullptr) continue;
    values_.resize(chunk.count * wave.count * components);
    const auto copy = [this](std::size_t to, std::size_t from) { values_[to] = forces_of_chunk_[from]; };
    if (alone) {
      for_each_place(chunk.count, lanes, components * lanes, lanes, 1, copy);
      add_forces(chunk, values_, lanes, ghosted_forces);
    } else {
      for_each_place(chunk.count, wave.count, components * wave.count, 1, components, copy);
      const auto own = transpose->to_blocks(values_);
      if (lanes > 0) add_forces(chunk, own.front(), lanes, ghosted_forces);
    }
  }
  if (forces == nullptr || lanes == 0) return;
  resize(*forces, static_cast<int>(grid.owned_nodes().count()), 3, lanes);
  grid.exchange(3 * lanes).add_to_owned(ghosted_forces, forces->values);
}

void PlasticExchange::set_modes(const PlasticBatches::Chunk& chunk, std::span<const double> ghosted,
                                int lanes, std::vector<double>& modes) const {
  const Grid<3>& grid = model_.part.grid();
  modes.resize((chunk.end - chunk.begin) * components * lanes);
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
      ElementModes::Nodal<Width> u;
      for (int corner = 0; corner < 8; ++corner) {
        const std::size_t node = model_.domain.first_corners[e] + grid.corner_offsets()[corner];
        for (int a = 0; a < 3; ++a)
          u[a][corner] = Lanes<Width>::load(&ghosted[(node * 3 + a) * lanes + first]);
      }
      const auto of_element = modes_.of<Width>(u);
      for (int c = 0; c < components; ++c)
        of_element[c].store(&modes[((e - chunk.begin) * components + c) * lanes + first]);
    }
  });
}

void PlasticExchange::add_forces(const PlasticBatches::Chunk& chunk, std::span<const double> modes, int lanes,
                                 std::span<double> ghosted) const {
  const Grid<3>& grid = model_.part.grid();
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
      ElementModes::Modes<Width> of_element;
      for (int c = 0; c < components; ++c)
        of_element[c] = Lanes<Width>::load(&modes[((e - chunk.begin) * components + c) * lanes + first]);
      const auto f = modes_.forces<Width>(of_element);
      for (int corner = 0; corner < 8; ++corner) {
        const std::size_t node = model_.domain.first_corners[e] + grid.corner_offsets()[corner];
        for (int a = 0; a < 3; ++a) {
          double* place = &ghosted[(node * 3 + a) * lanes + first];
          (Lanes<Width>::load(place) + f[a][corner]).store(place);
        }
      }
    }
  });
}

}  // namespace fabseq
