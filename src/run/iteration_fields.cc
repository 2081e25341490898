// SPDX-License-Identifier: MIT
#include "fabseq/run/iteration_fields.h"

#include "fabseq/files/field_dump.h"

#include <cstdio>
#include <string>
#include <vector>

namespace fabseq {

namespace {

/// Density, design, and what the pipeline's last run led to; `displacement` may be empty.
template <int Dim>
void dump(const Model<Dim>& model, const OutputDirectory& directory, const std::string& name,
          const Pipeline<Dim>& pipeline, std::span<const double> share,
          const std::vector<double>& displacement) {
  const std::vector<double> design = model.design_field(share);
  std::vector<double> time, layer;
  FieldSet<Dim> fields;
  fields.grid = &model.grid;
  fields.add_elements("density", model.part.density());
  const PseudoTime<Dim>* last = pipeline.last_time();
  if (last != nullptr) {
    time = model.part.expand(last->time);
    layer = model.part.expand(pipeline.last_layer_index());
    fields.add_elements("time", time);
    fields.add_elements("layer", layer);
  }
  fields.add(model.design_support.on_nodes(), "design", design);
  if (last != nullptr && !last->temperature.empty()) fields.add_nodes("temperature", last->temperature);
  if (!displacement.empty()) fields.add_nodes("displacement", displacement, Dim);
  directory.make_folder("fields");
  write_field_dump(model.world(), fields, directory.file("fields/" + name));
}

std::string name_of(int iteration) {
  char name[32];
  std::snprintf(name, sizeof name, "iteration_%04d", iteration);
  return name;
}

}  // namespace

template <int Dim>
void dump_iteration(const Model<Dim>& model, const OutputDirectory& directory, int iteration,
                    const Pipeline<Dim>& pipeline, const PipelineState<Dim>& state, const Design& design) {
  dump(model, directory, name_of(iteration), pipeline, design.field, state.process.displacement);
}

template <int Dim>
void dump_failed_iteration(const Model<Dim>& model, const OutputDirectory& directory, int iteration,
                           const Pipeline<Dim>& pipeline, std::span<const double> share) {
  dump(model, directory, name_of(iteration) + "_failed", pipeline, share, {});
}

FABSEQ_INSTANTIATE_FUNCTION(dump_iteration);
FABSEQ_INSTANTIATE_FUNCTION(dump_failed_iteration);

}  // namespace fabseq
