// SPDX-License-Identifier: MIT
#include "fabseq/report/sequence_report.h"

#include "fabseq/process/counted_as.h"
#include "fabseq/responses/layer_statistics.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace fabseq {

namespace {

template <int Dim>
std::vector<LayerNumbers> layer_numbers(const Model<Dim>& model, const StageResults<Dim>& state) {
  const auto statistics = layer_statistics(model.context(), *state.time, *state.densities);
  const SubParts& sub_parts = state.densities->sub_parts;
  std::vector<LayerNumbers> result;
  for (int j = 0; j < state.densities->count(); ++j) {
    result.push_back(
        {statistics[j].volume, statistics[j].thickness, statistics[j].coefficient_of_variation()});
    if (state.temperatures) result.back().interpass = state.temperatures->interpass[j];
    if (sub_parts.count() == 0) continue;
    result.back().sub_part = sub_parts.of_layer[j] + 1;
    result.back().slab = sub_parts.slab[j];
  }
  return result;
}

/// Returns the numbers by the model that the state now counts by.
template <int Dim>
DepositionNumbers deposition_numbers(const Model<Dim>& model, const Problem<Dim>& problem,
                                     Pipeline<Dim>& pipeline, const StageResults<Dim>& state) {
  DepositionNumbers result{displacement_sizes(model, state.process->displacement), {}};
  const auto terms = problem.responses().first(problem.objective_count());
  for (NamedValue& term : problem.describe(pipeline.values(terms, state)))
    if (term.type == "distortion") result.distortions.push_back(std::move(term));
  return result;
}

/// What the scenarios of the strain (docs/formulation.md 4.7) make of a pipeline's last run, for each term of
/// the objective that can be aggregated over them, whichever aggregate it asks for; empty without scenarios.
/// No solve: they are superposed.
template <int Dim>
std::vector<ScenarioNumbers> report_scenarios(const Model<Dim>& model, const Problem<Dim>& problem,
                                              Pipeline<Dim>& pipeline, const StageResults<Dim>& state) {
  std::vector<ScenarioNumbers> result;
  if (model.settings.material.scenarios.empty()) return result;
  for (std::size_t i = 0; i < model.settings.objective.size(); ++i) {
    const Term& term = model.settings.objective[i];
    const auto worst = term.type->aggregated(term, Aggregate::worst);
    const auto spread = term.type->aggregated(term, Aggregate::spread);
    if (!worst || !spread) continue;
    ResponseList<Dim> responses;
    responses.push_back(term.type->make(*worst, model.context())->largest_of());
    responses.push_back(term.type->make(*spread, model.context()));
    auto values = pipeline.values(responses, state);
    ScenarioNumbers numbers{problem.component_name(i, 0), std::move(values[0])};
    const auto& all = numbers.values;
    numbers.mean = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
    numbers.spread = values[1][0];
    numbers.worst = *std::max_element(all.begin(), all.end());
    result.push_back(std::move(numbers));
  }
  return result;
}

}  // namespace

int SequenceNumbers::used_layers() const {
  double total = 0.0;
  for (const LayerNumbers& layer : layers) total += layer.volume;
  return static_cast<int>(std::count_if(layers.begin(), layers.end(), [&](const LayerNumbers& layer) {
    return layer.volume > 1e-6 * total / static_cast<double>(layers.size());
  }));
}

template <int Dim>
void add_sequence_fields(FieldSet<Dim>& fields, const Part<Dim>& part, const SequenceReport& report,
                         const std::string& prefix) {
  fields.add_elements(prefix + "time", report.time, 1, &part.elements());
  if (any(part.grid().comm(), !report.time_gradient.empty()))
    fields.add_elements(prefix + "time_gradient", report.time_gradient, Dim, &part.elements());
  fields.add_elements(prefix + "layer", report.layer, 1, &part.elements());
  add_build_fields(fields, part, report.build_fields, prefix);
  if (!report.temperature.empty()) fields.add_nodes(prefix + "temperature", report.temperature);
  if (!report.nodal_time.empty()) fields.add_nodes(prefix + "nodal_time", report.nodal_time);
  add_displacements(fields, report, prefix);
}

template <int Dim>
void add_displacements(FieldSet<Dim>& fields, const SequenceReport& report, const std::string& prefix) {
  const auto add = [&](const char* name, const std::vector<double>& values, const char* description) {
    fields.add_nodes(prefix + name, values, Dim, &report.nodes, description);
  };
  add("displacement", report.displacement, "u: displacement after the last layer, before the release");
  if (!report.finished || !report.finished->released) return;
  add("release_displacement", report.finished->release,
      "v: increment that the release adds to displacement; no displacement of the released part itself");
  add("released_displacement", report.finished->released_displacement,
      "u + v: displacement of the part after its release, the sum of displacement and release_displacement");
}

template <int Dim>
BothDepositions report_depositions(const Model<Dim>& model, const Problem<Dim>& problem,
                                   Pipeline<Dim>& pipeline, const StageResults<Dim>& state) {
  const DepositionModel own_model = model.settings.process.deposition;
  const bool is_nominal = own_model == DepositionModel::nominal;
  const DepositionModel other_model = is_nominal ? DepositionModel::follow : DepositionModel::nominal;
  DepositionNumbers own = deposition_numbers(model, problem, pipeline, state);
  if (pipeline.region() == SolverRegion::built) return {std::move(own), std::nullopt, own_model};
  const CountedAs<Dim> counted(other_model, pipeline.process().model(), model.groups, *state.densities,
                               pipeline.process().result());
  return {std::move(own), deposition_numbers(model, problem, pipeline, state), own_model};
}

template <int Dim>
SequenceReport report_sequence(const Model<Dim>& model, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                               const StageResults<Dim>& state, bool with_shape) {
  SequenceReport report;
  report.values = pipeline.values(problem.responses(), state);
  report.responses = problem.describe(report.values);
  report.layers = layer_numbers(model, state);
  report.depositions = report_depositions(model, problem, pipeline, state);
  report.scenarios = report_scenarios(model, problem, pipeline, state);
  if (with_shape) report.finished = finished_shape(model, pipeline, state);
  BuildReport build = with_shape ? report_build(model, pipeline, state, report.used_layers())
                                 : report_evaluation(model, pipeline, state);
  report.found = std::move(build.numbers);
  report.build_fields = std::move(build.fields);
  if (with_shape) report.verdict = judge(report.found, model.settings);
  report.time = state.time->time;
  report.time_gradient = state.time->gradient.empty() ? state.time->recorded_gradient : state.time->gradient;
  report.layer = pipeline.last_layer_index();
  report.temperature = state.time->temperature;
  report.nodal_time = state.time->nodal;
  report.nodes = pipeline.process().model().nodes;
  report.displacement = pipeline.process().model().at_nodes(state.process->displacement);
  return report;
}

FABSEQ_INSTANTIATE_FUNCTION(add_sequence_fields);
FABSEQ_INSTANTIATE_FUNCTION(add_displacements);
FABSEQ_INSTANTIATE_FUNCTION(report_depositions);
FABSEQ_INSTANTIATE_FUNCTION(report_sequence);

}  // namespace fabseq
