// SPDX-License-Identifier: MIT
#include "fabseq/run/sequence_report.h"

#include "fabseq/responses/layer_statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

template <int Dim>
std::vector<LayerNumbers> layer_numbers(const Model<Dim>& model, const PipelineState<Dim>& state) {
  const LayerStatistics statistics = layer_statistics(model.context(), state.time, state.layers);
  const SubParts& sub_parts = state.layers.sub_parts;
  std::vector<LayerNumbers> result;
  for (int j = 0; j < state.layers.count(); ++j) {
    result.push_back({statistics.volume[j], statistics.thickness[j], statistics.coefficient_of_variation(j)});
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
void add_sequence_fields(FieldSet<Dim>& fields, const SequenceReport& report, const std::string& prefix) {
  fields.add_elements(prefix + "time", report.time);
  fields.add_elements(prefix + "layer", report.layer);
  add_build_fields(fields, report.build_fields, prefix);
  if (!report.temperature.empty()) fields.add_nodes(prefix + "temperature", report.temperature);
  fields.add_nodes(prefix + "displacement", report.displacement, Dim);
  if (report.finished && !report.finished->release.empty())
    fields.add_nodes(prefix + "release_displacement", report.finished->release, Dim);
}

template <int Dim>
SequenceReport report_sequence(const Model<Dim>& model, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                               const PipelineState<Dim>& state, bool with_shape) {
  SequenceReport report;
  report.values = pipeline.values(problem.responses(), state);
  report.responses = problem.describe(report.values);
  report.layers = layer_numbers(model, state);
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

FABSEQ_INSTANTIATE_FUNCTION(add_sequence_fields);
FABSEQ_INSTANTIATE_FUNCTION(report_sequence);

}  // namespace fabseq
