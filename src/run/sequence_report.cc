// SPDX-License-Identifier: MIT
#include "fabseq/run/sequence_report.h"

#include "fabseq/responses/layer_statistics.h"
#include "fabseq/run/deposition_report.h"
#include "fabseq/run/scenario_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

template <int Dim>
std::vector<LayerNumbers> layer_numbers(const Model<Dim>& model, const PipelineState<Dim>& state) {
  const auto statistics = layer_statistics(model.context(), state.time, state.layers);
  const SubParts& sub_parts = state.layers.sub_parts;
  std::vector<LayerNumbers> result;
  for (int j = 0; j < state.layers.count(); ++j) {
    result.push_back(
        {statistics[j].volume, statistics[j].thickness, statistics[j].coefficient_of_variation()});
    if (sub_parts.count() == 0) continue;
    result.back().sub_part = sub_parts.of_layer[j] + 1;
    result.back().slab = sub_parts.slab[j];
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
void SequenceReport<Dim>::add_fields(FieldSet<Dim>& fields, const std::string& prefix) const {
  fields.add_elements(prefix + "time", time);
  fields.add_elements(prefix + "layer", layer);
  add_build_fields(fields, build_fields, prefix);
  if (!temperature.empty()) fields.add_nodes(prefix + "temperature", temperature);
  fields.add_nodes(prefix + "displacement", displacement, Dim);
  if (finished && !finished->release.empty())
    fields.add_nodes(prefix + "release_displacement", finished->release, Dim);
}

template <int Dim>
SequenceReport<Dim> report_sequence(const Model<Dim>& model, const Problem<Dim>& problem,
                                    Pipeline<Dim>& pipeline, const PipelineState<Dim>& state,
                                    bool with_shape) {
  SequenceReport<Dim> report;
  report.values = pipeline.values(problem.responses(), state);
  report.responses = problem.describe(report.values);
  report.layers = layer_numbers(model, state);
  report.displacement_size = displacement_size(model.part, state.process.displacement);
  report.depositions = report_depositions(model, problem, pipeline, state);
  report.scenarios = report_scenarios(model, problem, pipeline, state);
  if (with_shape) {
    report.finished = finished_shape(model, pipeline, state);
    BuildReport build = report_build(model, pipeline, state, report.used_layers());
    report.build = std::move(build.numbers);
    report.build_fields = std::move(build.fields);
  }
  report.time = model.part.expand(state.time.time);
  report.layer = model.part.expand(pipeline.last_layer_index());
  report.temperature = state.time.temperature;
  report.displacement = state.process.displacement;
  return report;
}

FABSEQ_INSTANTIATE_STRUCT(SequenceReport);
FABSEQ_INSTANTIATE_FUNCTION(report_sequence);

}  // namespace fabseq
