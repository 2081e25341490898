// SPDX-License-Identifier: MIT
#include "process/plastic_exchange.h"

#include "fabseq/parallel/step_transpose.h"
#include "process/plastic_point.h"

#include <cstddef>
#include <optional>

namespace fabseq {

namespace {

constexpr int components = ElementModes::components;

/// Calls f(entry of StepTranspose's histories, [element][step][component], entry of the batches' ones).
template <class Function>
void for_each_entry(std::size_t elements, int steps, Function&& f) {
  for (std::size_t e = 0; e < elements; ++e) {
    const std::size_t from = e * steps * components,
                      to = e / plastic_width * steps * components * plastic_width + e % plastic_width;
    for (int i = 0; i < steps * components; ++i) f(from + i, to + i * plastic_width);
  }
}

}  // namespace

void PlasticExchange::run(const PlasticWave& wave, std::span<const LaneVector* const> fields,
                          LaneVector* forces, const Work& work) const {
  const int lanes = wave.lanes(groups_.index());
  const bool alone = groups_.count() == 1;
  histories_.resize(fields.size());
  ghosted_.resize(fields.size());
  std::vector<std::span<const double>> values(fields.size());
  for (std::size_t k = 0; lanes > 0 && k < fields.size(); ++k)
    values[k] = nodes_.values(*fields[k], ghosted_[k]);
  std::span<double> sum;
  if (forces != nullptr) sum = nodes_.begin_forces(lanes, *forces, ghosted_forces_);
  std::vector<std::vector<double>> blocks(lanes > 0 ? 1 : 0);
  for (const PlasticBatches::Chunk& chunk : batches_.chunks()) {
    std::optional<StepTranspose> transpose;
    if (!alone) transpose.emplace(groups_, wave.deal, chunk.end - chunk.begin, components);
    const std::size_t size = chunk.batches() * wave.count * components * plastic_width;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (alone) {
        nodes_.set_histories(chunk, values[k], lanes, histories_[k]);
        continue;
      }
      if (lanes > 0) nodes_.set_block(chunk, values[k], lanes, blocks.front());
      const std::vector<double> found = transpose->to_histories(blocks);
      // Elements that are missing in the last batch do not move.
      histories_[k].assign(size, 0.0);
      for_each_entry(chunk.count, wave.count,
                     [&](std::size_t from, std::size_t to) { histories_[k][to] = found[from]; });
    }
    if (forces != nullptr) forces_of_chunk_.resize(size);
    work(chunk, histories_, forces_of_chunk_);
    if (forces == nullptr) continue;
    if (alone) {
      nodes_.add_histories(chunk, forces_of_chunk_, lanes, sum);
      continue;
    }
    values_.resize(chunk.count * wave.count * components);
    for_each_entry(chunk.count, wave.count,
                   [this](std::size_t to, std::size_t from) { values_[to] = forces_of_chunk_[from]; });
    const auto own = transpose->to_blocks(values_);
    if (lanes > 0) nodes_.add_block(chunk, own.front(), lanes, sum);
  }
  if (forces != nullptr && lanes > 0) nodes_.end_forces(ghosted_forces_, *forces);
}

void PlasticExchange::release_memory() const {
  for (std::vector<double>* scratch : {&ghosted_forces_, &forces_of_chunk_, &values_}) *scratch = {};
  ghosted_.clear();
  histories_.clear();
}

}  // namespace fabseq
