// SPDX-License-Identifier: MIT
#include "fabseq/run/sequence_report.h"

#include "fabseq/base/mpi.h"
#include "fabseq/responses/layer_statistics.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

template <int Dim>
Json layer_table(const Setup<Dim>& setup, const PipelineState<Dim>& state) {
  const LayerStatistics statistics = layer_statistics(setup.context(), state.time, state.layers);
  Json table = Json::array();
  const SubParts& sub_parts = state.layers.sub_parts;
  for (int j = 0; j < state.layers.count(); ++j) {
    table.push_back(Json::object({{"volume", statistics.volume[j]},
                                  {"thickness", statistics.thickness[j]},
                                  {"cv", statistics.coefficient_of_variation(j)}}));
    if (sub_parts.count() == 0) continue;
    table.back()["subpart"] = sub_parts.of_layer[j] + 1;
    table.back()["slab"] = sub_parts.slab[j];
  }
  return table;
}

}  // namespace

template <int Dim>
Json displacement_size(const Part<Dim>& part, const std::vector<double>& displacement) {
  double largest = 0.0, total = 0.0, count = 0.0;
  for (std::size_t node = 0; node < part.touched_nodes().size(); ++node) {
    if (part.touched_nodes()[node] == 0) continue;
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(displacement[node * Dim + axis], 2);
    largest = std::max(largest, std::sqrt(square));
    total += square;
    count += 1.0;
  }
  const MPI_Comm comm = part.grid().comm();
  return Json::object({{"max", max(comm, largest)}, {"rms", std::sqrt(sum(comm, total) / sum(comm, count))}});
}

template <int Dim>
void SequenceReport<Dim>::add_fields(FieldSet<Dim>& fields, const std::string& prefix) const {
  fields.add_elements(prefix + "time", time);
  fields.add_elements(prefix + "layer", layer);
  if (!temperature.empty()) fields.add_nodes(prefix + "temperature", temperature);
  fields.add_nodes(prefix + "displacement", displacement, Dim);
}

template <int Dim>
SequenceReport<Dim> report_sequence(const Setup<Dim>& setup, const Problem<Dim>& problem,
                                    Pipeline<Dim>& pipeline, const PipelineState<Dim>& state) {
  SequenceReport<Dim> report;
  report.values = pipeline.values(problem.responses(), state);
  report.block = Json::object({{"responses", problem.describe(report.values)},
                               {"layers", layer_table(setup, state)},
                               {"displacement", displacement_size(setup.part, state.process.displacement)}});
  report.time = setup.part.expand(state.time.time);
  report.layer = setup.part.expand(pipeline.last_layer_index());
  report.temperature = state.time.temperature;
  report.displacement = state.process.displacement;
  return report;
}

int used_layers(const Json& block) {
  const auto& layers = block.at("layers");
  double total = 0.0;
  for (const Json& layer : layers) total += layer.at("volume").get<double>();
  return static_cast<int>(std::count_if(layers.begin(), layers.end(), [&](const Json& layer) {
    return layer.at("volume").get<double>() > 1e-6 * total / static_cast<double>(layers.size());
  }));
}

template Json displacement_size<2>(const Part<2>&, const std::vector<double>&);
template Json displacement_size<3>(const Part<3>&, const std::vector<double>&);
template struct SequenceReport<2>;
template struct SequenceReport<3>;
template SequenceReport<2> report_sequence<2>(const Setup<2>&, const Problem<2>&, Pipeline<2>&,
                                              const PipelineState<2>&);
template SequenceReport<3> report_sequence<3>(const Setup<3>&, const Problem<3>&, Pipeline<3>&,
                                              const PipelineState<3>&);

}  // namespace fabseq
