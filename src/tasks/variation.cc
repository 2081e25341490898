// SPDX-License-Identifier: MIT
#include "tasks/variation.h"

#include "fabseq/chain/stages.h"
#include "fabseq/layers/curved_layers.h"
#include "fabseq/process/superposition.h"
#include "fabseq/report/sequence_report.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/given_sequence.h"
#include "tasks/config_changes.h"
#include "tasks/refined_time.h"

#include <cmath>
#include <memory>
#include <utility>

namespace fabseq {

namespace {

VariedNumbers numbers_of(const DepositionNumbers& numbers) {
  VariedNumbers result{{}, numbers.part.largest, numbers.part.rms};
  for (const NamedValue& term : numbers.distortions) result.distortions.emplace_back(term.value);
  return result;
}

/// J of each distortion term for one layer's part of the displacement; none for those that are no quadratic
/// form of it.
template <int Dim>
std::vector<std::optional<double>> quadratic_terms(const Model<Dim>& model, const Problem<Dim>& problem,
                                                   Pipeline<Dim>& pipeline, const StageResults<Dim>& state) {
  std::vector<std::optional<double>> result;
  for (std::size_t k = 0; k < problem.objective_count(); ++k) {
    const Term& term = model.settings.objective[k];
    if (term.type->name != "distortion") continue;
    result.emplace_back();
    if (term.type->facts(term).is_quadratic)
      result.back() = pipeline.values(problem.responses().subspan(k, 1), state)[0][0];
  }
  return result;
}

/// Noise of each layer's strain, independent of the others': var(u) = sigma^2 sum_j du_j^2 of what counts,
/// and the mean of J is J(u) + sigma^2 sum_j J(du_j).
template <int Dim>
VariedNumbers with_noise(const Model<Dim>& model, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state, VariedNumbers numbers) {
  const Superposition& linear = *state.process->superposition;
  std::vector<double> deviation(state.process->displacement.size(), 0.0);
  for (int j = 0; j < state.densities->count(); ++j) {
    const ProcessResult layer = linear.of_part(*state.process, pipeline.process().layer_increment(j, true));
    for (std::size_t i = 0; i < deviation.size(); ++i)
      deviation[i] += std::pow(size_of_change * layer.displacement[i], 2);
    const auto terms = quadratic_terms(model, problem, pipeline, {state.time, state.densities, layer});
    for (std::size_t k = 0; k < terms.size(); ++k) {
      if (!terms[k]) numbers.distortions[k].reset();
      if (numbers.distortions[k]) *numbers.distortions[k] += size_of_change * size_of_change * *terms[k];
    }
  }
  for (double& value : deviation) value = std::sqrt(value);
  const DisplacementSize size = displacement_sizes(model, deviation).part;
  numbers.largest.reset();
  numbers.rms = std::hypot(numbers.rms, size.rms);
  numbers.largest_deviation = size.largest;
  numbers.rms_deviation = size.rms;
  return numbers;
}

template <int Dim>
Varied simulate(const Model<Dim>& model, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                const Design& design, double beta, bool binary, bool more) {
  const auto state = pipeline.run(design, beta, binary);
  const BothDepositions both = report_depositions(model, problem, pipeline, state);
  Varied result{numbers_of(both.own), std::nullopt, std::nullopt};
  if (!more) return result;
  result.other_deposition = numbers_of(both.other.value());
  result.noise = with_noise(model, problem, pipeline, state, result.own);
  return result;
}

/// The config of a change.
template <int Dim>
Config varied(const Setup<Dim>& unchanged, const Variation& variation) {
  Config config = config_to_change(unchanged);
  config.part.announce = variation.finer;  // else as of the unchanged part
  variation.change(config);
  // Where something counts in what is not built yet, the solves are whole.
  if (!may_leave_out_unbuilt(config.process)) config.solver.region = SolverRegion::whole;
  complete_derived(config);
  return config;
}

}  // namespace

template <int Dim>
VariedPair simulate_varied(const Setup<Dim>& setup, const GivenDesign<Dim>& given, const Variation& variation,
                           bool more, PhaseTimer& timer) {
  const Config config = varied(setup, variation);
  const Setup<Dim> changed(setup.world(), config);
  changed.require_memory_of_layers();
  const Problem<Dim> problem(changed, config.optimizer.constraint_margin);
  const double tolerance = config.solver.finest_tolerance();
  VariedPair result;
  {
    PseudoTime<Dim> time = variation.finer ? refined_time(setup.part, given.time, changed.part) : given.time;
    Pipeline<Dim> pipeline(changed, std::make_unique<GivenSequence<Dim>>(std::move(time)), *changed.layers,
                           tolerance, timer);
    Design design;
    design.layer_variables = given.layer_variables;
    if (design.layer_variables.size() != changed.layers->variables().count())  // other time points
      design.layer_variables = interpolated_time_points(given.layer_variables, changed.layers->count());
    result.sequence = simulate(changed, problem, pipeline, design, given.beta, !variation.smooth, more);
  }
  Pipeline<Dim> planar(changed, make_baseline_sequence(changed), *changed.baseline, tolerance, timer);
  result.planar = simulate(changed, problem, planar, {}, 0.0, true, more);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(simulate_varied);

}  // namespace fabseq
