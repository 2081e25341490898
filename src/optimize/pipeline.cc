#include "fabseq/optimize/pipeline.h"

#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/heat_sequence.h"
#include "fabseq/solve/lane_elasticity.h"
#include "fabseq/solve/lane_heat.h"
#include "fabseq/solve/reference_elasticity.h"
#include "fabseq/solve/reference_heat.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Conjugate gradients stop making progress below this.
constexpr double smallest_tolerance = 1e-13;
/// A lane that needs more than this is solved again by the reference path.
constexpr int lane_iterations = 300;

LaneCycle lane_cycle(const SolverSettings& settings) {
  LaneCycle cycle;
  cycle.kind = settings.cycle;
  cycle.degree = settings.smoother_degree;
  return cycle;
}

template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const Setup<Dim>& setup,
                                                              const ElasticModel<Dim>& model,
                                                              double tolerance) {
  const SolverSettings& solver = setup.config.solver;
  if (solver.path == SolverPath::lanes)
    return std::make_unique<LaneElasticity<Dim>>(setup.grid, model.domain, model.material.poisson,
                                                 lane_cycle(solver), lane_iterations,
                                                 elasticity_solver_settings(setup.config, tolerance));
  return std::make_unique<ReferenceElasticity<Dim>>(setup.grid, model.domain, model.element.stiffness(),
                                                    elasticity_solver_settings(setup.config, tolerance));
}

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_heat_solver(const Setup<Dim>& setup, const HeatModel<Dim>& model,
                                                  double tolerance) {
  const AssembledSolverSettings settings = heat_solver_settings(setup.config, tolerance);
  if (setup.config.solver.path == SolverPath::lanes)
    return std::make_unique<LaneHeat<Dim>>(setup.grid, model.domain, model.lumped, lane_iterations, settings);
  return std::make_unique<ReferenceHeat<Dim>>(setup.grid, model.domain, model.lumped, settings);
}

}  // namespace

AssembledSolverSettings elasticity_solver_settings(const Config& config, double tolerance) {
  return {config.solver.method, std::max(tolerance, smallest_tolerance), 1000, "elasticity_"};
}

AssembledSolverSettings heat_solver_settings(const Config& config, double tolerance) {
  return {config.solver.method, std::max(1e-3 * tolerance, smallest_tolerance), 1000, "heat_"};
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_sequence(const Setup<Dim>& setup, double tolerance) {
  const SequenceSettings& settings = setup.config.sequence;
  switch (settings.type) {
    case SequenceType::planar:
      return std::make_unique<GivenSequence<Dim>>(planar_time(setup.part, settings.direction));
    case SequenceType::file:
      return std::make_unique<GivenSequence<Dim>>(
          time_from_file(setup.part, settings.file, settings.dataset));
    default:
      break;
  }
  const auto target = setup.config.target_thickness();
  const double gradient = target ? 1.0 / (setup.layer_count * *target) : 0.0;
  auto model = std::make_unique<const HeatModel<Dim>>(setup.part, settings);
  auto solver = make_heat_solver(setup, *model, tolerance);
  return std::make_unique<HeatSequence<Dim>>(setup.part, settings, gradient, std::move(model),
                                             std::move(solver));
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Setup<Dim>& setup) {
  return std::make_unique<GivenSequence<Dim>>(planar_time(setup.part, setup.config.baseline.direction));
}

template <int Dim>
Pipeline<Dim>::Pipeline(const Setup<Dim>& setup, std::unique_ptr<Sequence<Dim>> sequence, double tolerance,
                        PhaseTimer& timer)
    : setup_(setup),
      timer_(timer),
      sequence_(std::move(sequence)),
      model_(setup.part, setup.config.material, setup.config.process),
      process_(model_, make_elasticity_solver(setup, model_, tolerance)) {}

template <int Dim>
PipelineState<Dim> Pipeline<Dim>::run(std::span<const double> design, int layers, double beta, bool binary) {
  time_ = nullptr;
  {
    const auto scope = timer_.enter(Phase::heat);
    time_ = &sequence_->update(design);
  }
  {
    const auto scope = timer_.enter(Phase::layers);
    layers_.emplace(setup_.part.part_density(), layers, beta, binary);
    layers_->set_densities(time_->time, densities_);
  }
  const auto scope = timer_.enter(Phase::primal);
  const ProcessResult& result = process_.simulate(densities_);
  iterations_.primal = result.iterations;
  iterations_.adjoint.clear();
  iterations_.heat = {time_->iterations};
  return {*time_, densities_, result};
}

template <int Dim>
std::vector<std::vector<double>> Pipeline<Dim>::values(
    const std::vector<std::unique_ptr<Response<Dim>>>& responses, const PipelineState<Dim>& state) {
  const auto scope = timer_.enter(Phase::responses);
  std::vector<std::vector<double>> result;
  for (const auto& response : responses) result.push_back(response->values(state));
  return result;
}

template <int Dim>
std::vector<std::vector<double>> Pipeline<Dim>::gradients(
    const std::vector<std::unique_ptr<Response<Dim>>>& responses, const PipelineState<Dim>& state,
    const std::vector<GradientRow>& rows) {
  std::vector<PipelineAdjoint<Dim>> adjoints = explicit_derivatives(responses, state, rows);
  pull_back_process(state, adjoints);
  const std::vector<TimeDerivatives> times = pull_back_layers(state, adjoints);
  const auto scope = timer_.enter(Phase::heat);
  auto result = sequence_->pull_back(times);
  const std::vector<int> heat = sequence_->adjoint_iterations();
  iterations_.heat.insert(iterations_.heat.end(), heat.begin(), heat.end());
  return result;
}

template <int Dim>
void Pipeline<Dim>::start_cold() {
  sequence_->start_cold();
  process_.start_cold();
}

template <int Dim>
std::vector<PipelineAdjoint<Dim>> Pipeline<Dim>::explicit_derivatives(
    const std::vector<std::unique_ptr<Response<Dim>>>& responses, const PipelineState<Dim>& state,
    const std::vector<GradientRow>& rows) {
  const auto scope = timer_.enter(Phase::responses);
  std::vector<PipelineAdjoint<Dim>> adjoints;
  for (const GradientRow& row : rows) {
    adjoints.emplace_back(state.layers.count());
    for (const WeightedComponent& term : row)
      responses[term.response]->add_derivative(term.component, term.weight, state, adjoints.back());
  }
  return adjoints;
}

template <int Dim>
void Pipeline<Dim>::pull_back_process(const PipelineState<Dim>& state,
                                      std::vector<PipelineAdjoint<Dim>>& adjoints) {
  const auto scope = timer_.enter(Phase::adjoint);
  std::vector<ProcessAdjoint> rows;
  std::vector<DensityDerivatives*> derivatives;
  for (PipelineAdjoint<Dim>& adjoint : adjoints) {
    if (adjoint.process.displacement.empty() && adjoint.process.increments.empty()) continue;
    rows.push_back(std::move(adjoint.process));
    derivatives.push_back(&adjoint.densities);
  }
  if (!rows.empty()) process_.pull_back(state.layers, rows, derivatives);
  iterations_.adjoint = process_.adjoint_iterations();
}

template <int Dim>
std::vector<TimeDerivatives> Pipeline<Dim>::pull_back_layers(const PipelineState<Dim>& state,
                                                             std::vector<PipelineAdjoint<Dim>>& adjoints) {
  const auto scope = timer_.enter(Phase::layers);
  std::vector<TimeDerivatives> result;
  for (PipelineAdjoint<Dim>& adjoint : adjoints) {
    TimeDerivatives& time = result.emplace_back(std::move(adjoint.time));
    if (time.time.empty()) time.time.assign(state.time.time.size(), 0.0);
    layers_->pull_back(state.time.time, adjoint.densities, time.time);
  }
  return result;
}

template class Pipeline<2>;
template class Pipeline<3>;
template std::unique_ptr<Sequence<2>> make_sequence<2>(const Setup<2>&, double);
template std::unique_ptr<Sequence<3>> make_sequence<3>(const Setup<3>&, double);
template std::unique_ptr<Sequence<2>> make_baseline_sequence<2>(const Setup<2>&);
template std::unique_ptr<Sequence<3>> make_baseline_sequence<3>(const Setup<3>&);

}  // namespace fabseq
