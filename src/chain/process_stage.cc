// SPDX-License-Identifier: MIT
#include "fabseq/chain/process_stage.h"

#include "chain/step_temperatures.h"
#include "fabseq/model/run_cost.h"
#include "fabseq/process/elastic_process.h"
#include "fabseq/process/plastic_process.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/solve/reference/reference_elasticity.h"
#include "fabseq/solve/solvers.h"

#include <algorithm>
#include <deque>
#include <utility>

namespace fabseq {

namespace {

template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> elasticity_solver(const Model<Dim>& model,
                                                         const ElasticModel<Dim>& elastic, double tolerance) {
  return make_elasticity_solver(model.solver, model.grid, elastic.domain, elastic.element,
                                elastic.material.poisson, tolerance, model.lanes);
}

/// The process that a model asks for. Plastic flow is simulated in 3D.
template <int Dim>
std::unique_ptr<Process<Dim>> make_process(const StageContext<Dim>& context,
                                           const ElasticModel<Dim>& elastic) {
  const Model<Dim>& model = context.model;
  auto solver = elasticity_solver(model, elastic, context.tolerance);
  if constexpr (Dim == 3)
    if (model.settings.process.model == ProcessModel::elastoplastic)
      return std::make_unique<PlasticProcess>(elastic, std::move(solver), model.groups, model.block_solver(),
                                              model.lanes);
  return std::make_unique<ElasticProcess<Dim>>(elastic, std::move(solver), model.groups, model.block_solver(),
                                               model.lanes);
}

/// Name of the expected work in a checkpoint.
constexpr const char* expected_work_name = "process/expected_work";

/// The functionals of displacements that a row consists of, as few as possible.
std::vector<ProcessAdjoint> process_functionals(ProcessFunctionals& row, const ProcessResult& result) {
  std::vector<ProcessAdjoint> functionals = std::move(row.combinations);
  if (functionals.empty() || !row.is_zero())
    functionals.push_back(std::move(static_cast<ProcessAdjoint&>(row)));
  if (result.linear()) return result.superposition->reduced(std::move(functionals));
  return functionals;
}

/// What a path needs, measured (docs/developer/measuring.md).
struct PathCost {
  double bytes_per_unknown;    ///< of a system with its preconditioner; with lanes, per lane
  double seconds_per_unknown;  ///< of a solve on one core
};
constexpr PathCost lanes_cost{121.0, 4.5e-7};
constexpr PathCost reference_cost{3000.0, 1e-5};
/// What the narrower solvers add to that of a lane, where there are any (LaneCycle::narrows).
constexpr double narrower_bytes_per_unknown = 69.0;
/// The reference path keeps the factors of every layer.
constexpr double factor_bytes_per_unknown = 5000.0;

/// Systems of all groups with what is solved: load, solution and a copy with halo, of all nodes; then the
/// lane engine's own.
double bytes_of_systems(const RunSize& size, SolverPath path, int groups, int lanes) {
  if (path == SolverPath::reference) {
    const bool kept = size.unknowns <= static_cast<double>(ReferenceElasticity<3>::keep_limit);
    return size.unknowns *
           (kept ? size.layers * factor_bytes_per_unknown : reference_cost.bytes_per_unknown * groups);
  }
  const double vectors = 24.0 * size.nodes * size.dimension * lanes * groups;
  const double of_lane =
      lanes_cost.bytes_per_unknown + (saves_memory(lanes) ? 0.0 : narrower_bytes_per_unknown);
  return vectors + of_lane * size.unknowns * lanes * groups;
}

/// Bytes per element and wave, of its state, and per element and functional, of its dual.
constexpr double state_bytes = 176.0, dual_bytes = 168.0;
/// Bytes per unknown and lane that sweeps take: what Anderson's method keeps, and fields with halos; and with
/// several groups all steps of two fields and of the forces, and messages.
constexpr double sweep_bytes = 120.0, exchange_bytes = 48.0;
/// Seconds per unknown and step on one core, with the sweeps of an iteration that begins from the last
/// design's state: forward and of an adjoint, at one temperature and with those of the layers.
constexpr double flow_seconds = 2.7e-7, flow_adjoint_seconds = 1.1e-7, heated_seconds = 7e-7,
                 heated_adjoint_seconds = 6e-7;

/// Adds what a material that flows takes to the memory of a linear process, and sets its time.
StageCost with_flow(StageCost cost, const RunSize& size, int groups, int lanes) {
  const double elements = size.unknowns / size.dimension, steps = size.flow_steps,
               functionals = 1.0 + size.functionals;
  const bool heated = size.temperature_steps > 0.0;
  cost.held *= steps / size.layers;
  cost.held +=
      size.unknowns * steps * 8.0 * (1.0 + std::min<double>(functionals, StepSystems<3>::most_kept)) +
      elements * (state_bytes * (steps / widest_block + 2.0) + dual_bytes * functionals);
  cost.solving += size.unknowns * (sweep_bytes + (groups > 1 ? exchange_bytes : 0.0)) * lanes * groups;
  cost.seconds = size.unknowns * steps *
                 ((heated ? heated_seconds : flow_seconds) +
                  functionals * (heated ? heated_adjoint_seconds : flow_adjoint_seconds)) /
                 size.ranks;
  return cost;
}

/// Solutions kept of forward solves, and of adjoint ones where they are few (StepSystems).
double bytes_of_last_solutions(const RunSize& size) {
  const auto kept = [](int sides) { return sides <= StepSystems<3>::most_kept ? sides : 0; };
  if (!size.warm || size.flow_steps > 0) return 0.0;
  return 4.0 * size.unknowns * size.layers * (kept(size.cases) + kept(1 + size.functionals));
}

StageCost cost_of_process(const RunSize& size, SolverPath path, int groups, int lanes) {
  const std::vector<double> equal(size.layers, 1.0);
  const StepDeal deal = deal_out_steps(equal, groups, widest_block, block_solver(path));
  const double seconds =
      path == SolverPath::lanes ? lanes_cost.seconds_per_unknown : reference_cost.seconds_per_unknown;
  const double increments =
      size.unknowns * size.layers * 8.0 * (size.cases + 1.0 / static_cast<double>(size.dimension));
  const StageCost cost{
      .held = increments + bytes_of_last_solutions(size),
      .solving = bytes_of_systems(size, path, groups, lanes),
      .work = deal.longest,
      .work_of_other_groups = deal.total - deal.longest,
      .seconds = (1.0 + size.cases + size.functionals) * size.layers * size.unknowns * seconds / size.ranks};
  return size.flow_steps > 0 ? with_flow(cost, size, groups, lanes) : cost;
}

const RegisteredStage<ProcessStage> process_stage{
    {"process", {&Results::densities, &Results::strains}, {&Results::process}}, cost_of_process};

}  // namespace

template <int Dim>
ProcessStage<Dim>::ProcessStage(StageContext<Dim>& context)
    : elastic_(context.model.part, context.model.supports, context.model.settings.material,
               context.model.settings.process),
      process_(make_process(context, elastic_)),
      flows_(context.model.settings.process.model == ProcessModel::elastoplastic) {
  const ModelSettings& settings = context.model.settings;
  const bool is_measured =
      any_measures_release(settings.objective) || any_measures_release(settings.constraints);
  // What flows in the release is found with all else.
  const auto can_be_released = [&] {
    return release_obstacle(context.model.grid, context.model.supports, settings.process.void_model).empty();
  };
  if (is_measured || (flows_ && can_be_released()))
    process_->release_with(release_solver(settings.solver, context.tolerance));
  if (flows_ && settings.thermal) thermal_.emplace(*settings.thermal, settings.material, settings.process);
}

template <int Dim>
void ProcessStage<Dim>::forward(const StageInput& input, StageResults<Dim>& results) {
  process_->set_tolerance(elasticity_tolerance(input.tolerance));
  process_->systems().leave_out_unbuilt(input.region == SolverRegion::built && !flows_);
  ProcessInput<Dim> input_of_process{*results.densities, *results.strains, {}};
  if (thermal_) {
    input_of_process.steps = steps_of_heated_layers(results.densities->count(), *thermal_);
    temperatures_ = step_temperatures(elastic_, *thermal_, *results.temperatures, input_of_process.steps);
    input_of_process.temperatures = &temperatures_;
  } else {
    input_of_process.steps = steps_of_layers(results.densities->count());
  }
  results.process = process_->simulate(input_of_process);
  forward_iterations_ = results.process->iterations;
  adjoint_iterations_.clear();
}

template <int Dim>
void ProcessStage<Dim>::pull_back(const StageResults<Dim>& state, const SolveTolerance& tolerance,
                                  AdjointRowSpan<Dim> rows) {
  std::vector<ProcessAdjoint> adjoints;
  std::vector<ProcessDerivatives> derivatives;
  const bool has_strains = process_->strains().input_count() > 0;
  std::deque<std::vector<std::vector<double>>> of_temperatures;
  std::vector<AdjointRow<Dim>*> row_of;
  for (AdjointRow<Dim>* row : rows) {
    if (!row->shared) continue;
    for (ProcessAdjoint& functional : process_functionals(row->adjoint.process, *state.process)) {
      adjoints.push_back(std::move(functional));
      row_of.push_back(row);
      derivatives.push_back({&row->adjoint.densities, has_strains ? &row->adjoint.strains.inputs : nullptr,
                             thermal_ ? &of_temperatures.emplace_back() : nullptr, &row->sink});
    }
  }
  if (adjoints.empty()) return;
  process_->set_tolerance(elasticity_tolerance(tolerance));
  process_->pull_back(*state.densities, adjoints, derivatives);
  for (std::size_t k = 0; k < of_temperatures.size(); ++k)
    add_end_derivatives(elastic_, state.process->steps, of_temperatures[k], row_of[k]->adjoint.temperatures);
  adjoint_iterations_ = process_->adjoint_iterations();
}

template <int Dim>
void ProcessStage<Dim>::save(CheckpointState& state) const {
  // Nothing yet before the first iteration.
  if (!process_->systems().expected_work().empty())
    state.set_array(expected_work_name, process_->systems().expected_work());
}

template <int Dim>
void ProcessStage<Dim>::restore(const CheckpointState& state) {
  if (state.has_array(expected_work_name))
    process_->systems().set_expected_work(state.array(expected_work_name));
}

template <int Dim>
void ProcessStage<Dim>::add_iterations(SolverIterations& iterations) const {
  iterations.primal = forward_iterations_;
  iterations.adjoint = adjoint_iterations_;
}

FABSEQ_INSTANTIATE_CLASS(ProcessStage);

}  // namespace fabseq
