// SPDX-License-Identifier: MIT
#include "fabseq/process/process.h"

#include <utility>

namespace fabseq {

template <int Dim>
Process<Dim>::Process(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
                      const LayerGroups& groups, BlockSolver blocks, int lanes)
    : systems_(model, std::move(solver), groups, blocks, lanes) {
  result_.all_layers = groups.world();
  if (model.settings.deposition == DepositionModel::nominal)
    deposition_ = std::make_unique<const Deposition<Dim>>(model);
}

template <int Dim>
void Process<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  systems_.set_tolerance(tolerance);
  if (release_) release_->set_tolerance(tolerance.value);
}

template <int Dim>
void Process<Dim>::start_cold() {
  systems_.start_cold();
  if (release_) release_->start_cold();
}

template <int Dim>
void Process<Dim>::release_memory() {
  systems_.release_memory();
  for (std::size_t number = 0; number < result_.case_count(); ++number)
    result_.of_case(number).increments = {};
  result_.weights = {};
}

template <int Dim>
std::vector<double> Process<Dim>::step_increment(int step, bool counted) const {
  const auto place = systems_.place_of(step);
  std::vector<double> result(result_.displacement.size());
  if (place.group == groups().index())
    for (std::size_t i = 0; i < result_.nodes[place.block].size() * Dim; ++i)
      result[result_.in_field(place.block, i, Dim)] = counted
                                                          ? result_.counted(place.block, i, place.lane)
                                                          : result_.increments[place.block](i, place.lane);
  groups().broadcast(place.group, result);
  return result;
}

template <int Dim>
std::vector<double> Process<Dim>::layer_increment(int layer, bool counted) const {
  std::vector<double> result(result_.displacement.size(), 0.0);
  for (std::size_t step = 0; step < result_.steps.size(); ++step)
    if (result_.steps[step].layer == layer)
      add_scaled(result, 1.0, step_increment(static_cast<int>(step), counted));
  return result;
}

FABSEQ_INSTANTIATE_CLASS(Process);

}  // namespace fabseq
