// SPDX-License-Identifier: MIT
#include "fabseq/chain/pipeline.h"

#include "fabseq/solve/heat_solver.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace fabseq {

namespace {

/// The stage of that kind. A chain without one is a mistake of the program.
template <class Kind, int Dim>
Kind* stage_of_kind(const std::vector<std::unique_ptr<Stage<Dim>>>& stages) {
  for (const auto& stage : stages)
    if (auto* found = dynamic_cast<Kind*>(stage.get())) return found;
  throw std::logic_error("a stage of the pipeline is missing");
}

}  // namespace

template <int Dim>
Pipeline<Dim>::Pipeline(const Model<Dim>& model, std::unique_ptr<Sequence<Dim>> sequence,
                        const LayerModel<Dim>& layers, double tolerance, PhaseTimer& timer)
    : model_(model),
      timer_(timer),
      tolerances_(Tolerances::all({tolerance})),
      stages_(make_stages<Dim>({model, layers, tolerance, std::move(sequence)})),
      sequence_(stage_of_kind<SequenceStage<Dim>>(stages_)),
      process_(stage_of_kind<ProcessStage<Dim>>(stages_)) {}

template <int Dim>
Pipeline<Dim>::Pipeline(const Model<Dim>& model, double tolerance, PhaseTimer& timer)
    : Pipeline(model, nullptr, *model.layers, tolerance, timer) {}

template <int Dim>
StageResults<Dim> Pipeline<Dim>::run(const Design& design, double beta, bool binary) {
  results_ = {};
  adjoint_iterations_.clear();
  layer_variables_ = design.layer_variables.size();
  const StageInput input{design, beta, binary, tolerances_.primal, region_};
  for (const auto& stage : stages_) {
    const auto scope = timer_.enter(stage->phase());
    stage->forward(input, results_);
  }
  return results_;
}

template <int Dim>
std::vector<std::vector<double>> Pipeline<Dim>::values(Responses<Dim> responses,
                                                       const StageResults<Dim>& state) {
  const auto scope = timer_.enter(Phase::responses);
  std::vector<std::vector<double>> result;
  for (const auto& response : responses) {
    std::vector<double>& values = result.emplace_back(response->values(state));
    // Decisions hang on them: sums of different groups may differ in the last bit.
    model_.groups.broadcast(0, values);
  }
  return result;
}

template <int Dim>
std::vector<Design> Pipeline<Dim>::gradients(Responses<Dim> responses, const StageResults<Dim>& state,
                                             const std::vector<GradientRow>& rows) {
  AdjointRows<Dim> adjoints(model_, timer_, responses, state, *results_.layers, rows, layer_variables_);
  const std::vector<AdjointRow<Dim>*> shared = adjoints.shared();
  {
    const auto scope = timer_.enter(Phase::responses);
    model_.groups.run([&] {
      for (AdjointRow<Dim>* row : shared) adjoints.add_explicit(*row);
    });
  }
  pull_back(state, shared, /*of_owner=*/false);
  {
    const auto scope = timer_.enter(Phase::layers);
    adjoints.sum_at_owners();
  }
  // What the groups send each other of the sequence's adjoints counts for it.
  const auto scope = timer_.enter(Phase::heat);
  pull_back_own(state, adjoints);
  if (state.time->iterations) adjoint_iterations_ = adjoints.iterations();
  return adjoints.gradients(sequence_->sequence().variables());
}

template <int Dim>
void Pipeline<Dim>::pull_back(const StageResults<Dim>& state, AdjointRowSpan<Dim> rows, bool of_owner) {
  for (std::size_t i = stages_.size(); i-- > 0;) {
    if (stages_[i]->runs_in_owner_group() != of_owner) continue;
    const auto scope = timer_.enter(stages_[i]->adjoint_phase());
    stages_[i]->pull_back(state, tolerances_.adjoint, rows);
  }
}

/// A group goes through its rows by as many as the heat solver takes together: what they have by the
/// pseudo-time takes memory.
template <int Dim>
void Pipeline<Dim>::pull_back_own(const StageResults<Dim>& state, AdjointRows<Dim>& adjoints) {
  const std::vector<AdjointRow<Dim>*> own = adjoints.own();
  model_.groups.run([&] {
    for (std::size_t first = 0; first < own.size(); first += widest_block) {
      const auto rows =
          std::span(own).subspan(first, std::min<std::size_t>(own.size() - first, widest_block));
      std::vector<AdjointRow<Dim>*> not_shared;
      for (AdjointRow<Dim>* row : rows)
        if (!row->shared) not_shared.push_back(row);
      for (AdjointRow<Dim>* row : not_shared) adjoints.add_explicit(*row);
      pull_back(state, not_shared, /*of_owner=*/false);
      pull_back(state, rows, /*of_owner=*/true);
    }
  });
}

template <int Dim>
void Pipeline<Dim>::start_cold() {
  for (const auto& stage : stages_) stage->start_cold();
}

template <int Dim>
void Pipeline<Dim>::save(CheckpointState& state) const {
  for (const auto& stage : stages_) stage->save(state);
}

template <int Dim>
void Pipeline<Dim>::restore(const CheckpointState& state) {
  for (const auto& stage : stages_) stage->restore(state);
}

template <int Dim>
void Pipeline<Dim>::release_memory() {
  for (const auto& stage : stages_) stage->release_memory();
}

template <int Dim>
SolverIterations Pipeline<Dim>::iterations() const {
  SolverIterations result;
  for (const auto& stage : stages_) stage->add_iterations(result);
  result.heat.insert(result.heat.end(), adjoint_iterations_.begin(), adjoint_iterations_.end());
  return result;
}

FABSEQ_INSTANTIATE_CLASS(Pipeline);

}  // namespace fabseq
