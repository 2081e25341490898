// SPDX-License-Identifier: MIT
#include "process/plastic_exchange.h"

#include "process/plastic_point.h"

namespace fabseq {

PlasticExchange::PlasticExchange(const ElasticModel<3>& model, const LayerGroups& groups,
                                 const PlasticBatches& batches)
    : groups_(groups), batches_(batches), nodes_(model) {
  for (int group = 0; group < groups.count(); ++group) {
    const std::size_t begin = groups.first_of_share(batches.elements(), group);
    const std::size_t end = groups.first_of_share(batches.elements(), group + 1);
    value_nodes_.push_back(nodes_.value_nodes(begin, end));
    force_nodes_.push_back(nodes_.force_nodes(begin, end));
  }
}

void PlasticExchange::set_wave(const PlasticWave& wave) {
  wave_ = wave;
  if (groups_.count() == 1) return;
  value_transpose_.emplace(groups_, wave.blocks, value_nodes_, 3);
  force_transpose_.emplace(groups_, wave.blocks, force_nodes_, 3);
}

/// Returns a field in all steps of the wave: the copies of this rank send what they solve.
NodeHistories<const double> PlasticExchange::values_of(const LaneVector& field, std::size_t number) const {
  std::span<const double> own;
  if (wave_.lanes(groups_.index()) > 0) own = nodes_.values(field, ghosted_[number]);
  if (!value_transpose_) return {own, 0, wave_.count};
  value_transpose_->to_histories(own, all_steps_[number]);
  return {all_steps_[number], value_transpose_->range().begin, wave_.count};
}

/// Where forces of all steps are added up: with one group in this rank's block.
NodeHistories<double> PlasticExchange::zero_forces(std::span<double> own) const {
  if (!force_transpose_) return {own, 0, wave_.count};
  forces_of_all_steps_.assign(force_transpose_->size_of_histories(), 0.0);
  return {forces_of_all_steps_, force_transpose_->range().begin, wave_.count};
}

void PlasticExchange::run(std::span<const LaneVector* const> fields, LaneVector* forces,
                          const Work& work) const {
  const int lanes = wave_.lanes(groups_.index());
  for (auto* scratch : {&ghosted_, &all_steps_, &histories_}) scratch->resize(fields.size());
  std::vector<NodeHistories<const double>> values;
  for (std::size_t k = 0; k < fields.size(); ++k) values.push_back(values_of(*fields[k], k));
  std::span<double> own_forces;
  NodeHistories<double> sum;
  if (forces != nullptr) {
    own_forces = nodes_.begin_forces(lanes, *forces, ghosted_forces_);
    sum = zero_forces(own_forces);
  }
  for (const PlasticBatches::Chunk& chunk : batches_.chunks()) {
    for (std::size_t k = 0; k < fields.size(); ++k) nodes_.set_histories(chunk, values[k], histories_[k]);
    if (forces != nullptr)
      forces_of_chunk_.resize(chunk.batches() * wave_.count * ElementModes::components * plastic_width);
    work(chunk, histories_, forces_of_chunk_);
    if (forces != nullptr) nodes_.add_histories(chunk, forces_of_chunk_, sum);
  }
  if (forces == nullptr) return;
  if (force_transpose_) force_transpose_->add_to_block(forces_of_all_steps_, own_forces);
  if (lanes > 0) nodes_.end_forces(ghosted_forces_, *forces);
}

void PlasticExchange::release_memory() {
  wave_ = {};
  value_transpose_.reset();
  force_transpose_.reset();
  for (auto* scratch : {&ghosted_forces_, &forces_of_all_steps_, &forces_of_chunk_}) *scratch = {};
  for (auto* scratch : {&ghosted_, &all_steps_, &histories_}) scratch->clear();
}

}  // namespace fabseq
