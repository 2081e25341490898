// SPDX-License-Identifier: MIT
#include "fabseq/optimize/pipeline.h"

#include "fabseq/optimize/stages.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/solve/heat_solver.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Its name in a checkpoint.
constexpr const char* expected_work_name = "process/expected_work";

bool any_measures_release(const std::vector<Term>& terms) {
  return std::any_of(terms.begin(), terms.end(),
                     [](const Term& term) { return term.type->facts(term).measures_release; });
}

/// The functionals of displacements that a row consists of, as few as possible.
template <int Dim>
std::vector<ProcessAdjoint> process_functionals(PipelineAdjoint<Dim>& row, std::size_t cases) {
  std::vector<ProcessAdjoint> result = std::move(row.combinations);
  if (result.empty() || !row.process.is_zero()) result.push_back(std::move(row.process));
  return reduced(std::move(result), cases);
}

}  // namespace

template <int Dim>
Pipeline<Dim>::Pipeline(const Model<Dim>& model, std::unique_ptr<Sequence<Dim>> sequence,
                        const LayerModel<Dim>& layers, double tolerance, PhaseTimer& timer)
    : model_(model),
      timer_(timer),
      sequence_(std::move(sequence)),
      layer_model_(layers),
      tolerances_(Tolerances::all({tolerance})),
      negligible_{tolerance * model.settings.process.min_stiffness, model.settings.process.strain_penalty},
      strain_(model.settings.material, model.characteristic_length),
      elastic_(model.part, model.supports, model.settings.material, model.settings.process),
      process_(elastic_, make_elasticity_solver(model, elastic_, tolerance), model.groups,
               model.block_solver(), model.lanes) {
  if (any_measures_release(model.settings.objective) || any_measures_release(model.settings.constraints))
    process_.release_with(release_solver(model.settings.solver, tolerance));
}

template <int Dim>
Pipeline<Dim>::Pipeline(const Model<Dim>& model, double tolerance, PhaseTimer& timer)
    : Pipeline(model, make_sequence(model, tolerance), *model.layers, tolerance, timer) {}

template <int Dim>
PipelineState<Dim> Pipeline<Dim>::run(const Design& design, double beta, bool binary) {
  solve_to(heat_tolerance(tolerances_.primal), elasticity_tolerance(tolerances_.primal));
  time_ = nullptr;
  layer_variables_ = design.layer_variables.size();
  {
    const auto scope = timer_.enter(Phase::heat);
    time_ = &sequence_->update(model_.groups.gather(design.field));
  }
  {
    const auto scope = timer_.enter(Phase::layers);
    layers_ = layer_model_.make(design.layer_variables, beta, binary, negligible_);
    layers_->set_densities(time_->time, densities_);
  }
  const auto scope = timer_.enter(Phase::primal);
  const ProcessResult& result = process_.simulate(densities_, strain_.strains(time_->gradient, densities_));
  iterations_.primal = result.iterations;
  iterations_.adjoint.clear();
  iterations_.heat.clear();
  if (!time_->temperature.empty()) iterations_.heat.push_back(time_->iterations);
  return {*time_, densities_, result};
}

template <int Dim>
std::vector<std::vector<double>> Pipeline<Dim>::values(Responses<Dim> responses,
                                                       const PipelineState<Dim>& state) {
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
std::vector<Design> Pipeline<Dim>::gradients(Responses<Dim> responses, const PipelineState<Dim>& state,
                                             const std::vector<GradientRow>& rows) {
  const SolveTolerance tolerance = elasticity_tolerance(tolerances_.adjoint);
  solve_to(tolerance, tolerance);
  std::vector<Row> dealt = deal_out_rows(responses, state, rows);
  pull_back_process(responses, state, dealt);
  pull_back_shared(state, dealt);
  auto fields = pull_back_own(responses, state, dealt);
  auto layer_variables = sum_up_layer_variables(dealt);
  std::vector<Design> result;
  for (std::size_t row = 0; row < rows.size(); ++row)
    result.push_back({std::move(fields[row]), std::move(layer_variables[row])});
  return result;
}

template <int Dim>
std::vector<typename Pipeline<Dim>::Row> Pipeline<Dim>::deal_out_rows(
    Responses<Dim> responses, const PipelineState<Dim>& state, const std::vector<GradientRow>& rows) const {
  std::vector<Row> result;
  for (const GradientRow& terms : rows) {
    const bool shared = std::any_of(terms.begin(), terms.end(), [&](const WeightedComponent& term) {
      return responses[term.response]->uses_displacements();
    });
    result.push_back({&terms, 0, shared, PipelineAdjoint<Dim>(state.layers.count()), {}, {}});
  }
  const std::vector<double> work(rows.size(), 1.0);  // one heat adjoint per row
  const LayerDeal deal =
      deal_out_layers(work, model_.groups.count(), HeatSolver<Dim>::widest, model_.block_solver());
  for (int group = 0; group < model_.groups.count(); ++group)
    for (const LayerBlock& block : deal.blocks[group])
      for (int row = block.first; row < block.first + block.lanes; ++row) result[row].owner = group;
  return result;
}

template <int Dim>
void Pipeline<Dim>::solve_to(const SolveTolerance& of_sequence, const SolveTolerance& of_process) {
  sequence_->set_tolerance(of_sequence);
  process_.set_tolerance(of_process);
}

template <int Dim>
void Pipeline<Dim>::start_cold() {
  sequence_->start_cold();
  process_.start_cold();
}

template <int Dim>
void Pipeline<Dim>::save(CheckpointState& state) const {
  // Nothing yet before the first iteration.
  if (!process_.expected_work().empty()) state.set_array(expected_work_name, process_.expected_work());
}

template <int Dim>
void Pipeline<Dim>::restore(const CheckpointState& state) {
  if (state.has_array(expected_work_name)) process_.set_expected_work(state.array(expected_work_name));
}

template <int Dim>
void Pipeline<Dim>::give_back_memory() {
  sequence_->give_back_memory();
  process_.give_back_memory();
  densities_ = {};
}

/// What else than the process a row depends on is in its owner's part of it. What it has by the layers'
/// densities is pulled back to the pseudo-time at once: rows by the dozen would fill the memory with it.
template <int Dim>
void Pipeline<Dim>::add_explicit_derivatives(Responses<Dim> responses, const PipelineState<Dim>& state,
                                             Row& row) {
  {
    const auto scope = timer_.enter(Phase::responses);
    for (const WeightedComponent& term : *row.terms)
      if (is_own(row) || responses[term.response]->uses_displacements())
        responses[term.response]->add_derivative(term.component, term.weight, state, row.adjoint);
    if (!is_own(row)) {
      PipelineAdjoint<Dim> of_process(state.layers.count());
      of_process.process = std::move(row.adjoint.process);
      of_process.combinations = std::move(row.adjoint.combinations);
      row.adjoint = std::move(of_process);
    }
  }
  const auto scope = timer_.enter(Phase::layers);
  take_up_densities(state, row);
}

template <int Dim>
void Pipeline<Dim>::pull_back_process(Responses<Dim> responses, const PipelineState<Dim>& state,
                                      std::vector<Row>& rows) {
  {
    const auto scope = timer_.enter(Phase::responses);
    model_.groups.run([&] {
      for (Row& row : rows)
        if (row.shared) add_explicit_derivatives(responses, state, row);
    });
  }
  const auto scope = timer_.enter(Phase::adjoint);
  std::vector<ProcessAdjoint> adjoints;
  std::vector<ProcessDerivatives> derivatives;
  const std::size_t cases = state.process.other_cases.size() + 1;
  for (Row& row : rows) {
    if (!row.shared) continue;
    for (ProcessAdjoint& functional : process_functionals(row.adjoint, cases)) {
      adjoints.push_back(std::move(functional));
      derivatives.push_back({&row.adjoint.densities, strain_.turns() ? &row.strains : nullptr,
                             [this, &state, &row] { take_up_densities(state, row); }});
    }
  }
  if (!adjoints.empty()) process_.pull_back(state.layers, adjoints, derivatives);
  iterations_.adjoint = process_.adjoint_iterations();
}

template <int Dim>
void Pipeline<Dim>::take_up_densities(const PipelineState<Dim>& state, Row& row) const {
  DensityDerivatives part(state.layers.count());
  part.stage.swap(row.adjoint.densities.stage);
  part.layer.swap(row.adjoint.densities.layer);
  std::vector<double>& d_time = DensityDerivatives::touch(row.adjoint.time.time, state.time.time.size());
  row.layer_variables.resize(layer_variables_, 0.0);
  layers_->pull_back(state.time.time, state.layers, part, d_time, row.layer_variables);
}

/// Sums up the parts that the groups have of a row at its owner.
template <int Dim>
void Pipeline<Dim>::pull_back_shared(const PipelineState<Dim>& state, std::vector<Row>& rows) {
  const auto scope = timer_.enter(Phase::layers);
  for (Row& row : rows) {
    if (!row.shared) continue;
    TimeDerivatives& time = row.adjoint.time;
    DensityDerivatives& densities = row.adjoint.densities;
    if (strain_.turns()) {
      strain_.pull_back(state.time.gradient, state.layers, row.strains, time.gradient, densities);
      if (densities.directions.empty()) model_.groups.sum_at(row.owner, time.gradient);
    }
    pull_back_layers(state, row);
    model_.groups.sum_at(row.owner, time.time);
  }
}

/// All that a row has by what the layers hold.
template <int Dim>
void Pipeline<Dim>::pull_back_layers(const PipelineState<Dim>& state, Row& row) const {
  // What is the same on all ranks counts once.
  if (!is_own(row) || rank_of(model_.groups.domain()) != 0) row.adjoint.densities.time_points.clear();
  layers_->pull_back(state.time.time, state.layers, row.adjoint.densities, row.adjoint.time.time,
                     row.layer_variables);
}

/// Gradients of all rows by this rank's share of the variables. A group goes through its rows by as many as
/// the heat solver takes together: what they have by the pseudo-time takes memory, too.
template <int Dim>
std::vector<std::vector<double>> Pipeline<Dim>::pull_back_own(Responses<Dim> responses,
                                                              const PipelineState<Dim>& state,
                                                              std::vector<Row>& rows) {
  std::vector<Row*> own;
  for (Row& row : rows)
    if (is_own(row)) own.push_back(&row);
  std::vector<std::vector<double>> gradients;
  std::vector<int> iterations(rows.size(), 0);
  const auto scope = timer_.enter(Phase::heat);
  model_.groups.run([&] {
    for (std::size_t first = 0; first < own.size(); first += HeatSolver<Dim>::widest) {
      std::vector<TimeDerivatives> times;
      const std::size_t end = std::min<std::size_t>(own.size(), first + HeatSolver<Dim>::widest);
      for (std::size_t k = first; k < end; ++k) {
        if (!own[k]->shared) {
          add_explicit_derivatives(responses, state, *own[k]);
          const auto of_layers = timer_.enter(Phase::layers);
          pull_back_layers(state, *own[k]);
        }
        times.push_back(std::move(own[k]->adjoint.time));
      }
      for (std::vector<double>& gradient : sequence_->pull_back(times))
        gradients.push_back(std::move(gradient));
      const std::vector<int> solves = sequence_->adjoint_iterations();
      for (std::size_t k = 0; k < solves.size(); ++k) iterations[own[first + k] - rows.data()] = solves[k];
    }
  });
  if (!time_->temperature.empty()) {
    model_.groups.sum(iterations);
    iterations_.heat.insert(iterations_.heat.end(), iterations.begin(), iterations.end());
  }
  std::vector<int> owners;
  for (const Row& row : rows) owners.push_back(row.owner);
  return model_.groups.share_out(gradients, owners, sequence_->variables());
}

/// Derivatives by the layers' variables of every row, from the parts of all ranks.
template <int Dim>
std::vector<std::vector<double>> Pipeline<Dim>::sum_up_layer_variables(const std::vector<Row>& rows) const {
  std::vector<std::vector<double>> result(rows.size());
  if (layer_variables_ == 0) return result;
  std::vector<double> sums(rows.size() * layer_variables_, 0.0);
  for (std::size_t row = 0; row < rows.size(); ++row)
    std::copy(rows[row].layer_variables.begin(), rows[row].layer_variables.end(),
              sums.begin() + static_cast<std::ptrdiff_t>(row * layer_variables_));
  sum_in_place(model_.world(), sums);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto first = sums.begin() + static_cast<std::ptrdiff_t>(row * layer_variables_);
    result[row].assign(first, first + static_cast<std::ptrdiff_t>(layer_variables_));
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(Pipeline);

}  // namespace fabseq
