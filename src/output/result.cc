// SPDX-License-Identifier: MIT
#include "fabseq/output/result.h"

#include "fabseq/base/formatted.h"
#include "fabseq/files/field_dump.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/output/model_group.h"
#include "fabseq/output/records.h"

#include <utility>

namespace fabseq {

template <int Dim>
void write_result(const Setup<Dim>& setup, const OutputDirectory& directory, const FinalReports& reports,
                  const SequenceReport& baseline, const BestIterate& best) {
  const std::vector<double> design = setup.design_field(best.design().field);
  const std::vector<double> substrate = setup.substrate_field();
  FieldSet<Dim> fields{&setup.grid, {}};
  fields.add_elements("density", setup.part.density());
  if (setup.part.substrate().count() > 0) fields.add_elements("substrate", substrate);
  fields.add(setup.design_support.on_nodes(), "design", design, setup.design_support.components());
  add_sequence_fields(fields, setup.part, reports.optimized, "");
  add_displacements(fields, reports.binary, "binary/");
  add_build_fields(fields, setup.part, reports.binary.build_fields, "binary/");
  add_sequence_fields(fields, setup.part, baseline, "planar/");
  if (reports.start) add_sequence_fields(fields, setup.part, *reports.start, "start/");
  for (const Baseline& other : reports.baselines)
    if (!other.group.empty()) add_sequence_fields(fields, setup.part, other.numbers, other.group);
  Hdf5Writer file(setup.world(), directory.file("result.h5"));
  file.template write_fields<Dim>(fields);
  write_layer_variables(file, setup.layers->variables(), "", best.design());
  write_model_group<Dim>(file, setup, reports.optimized.strain);
  file.write_attribute("name", setup.config.name);
  file.write_attribute("iteration", best.iteration());
  file.write_attribute("beta", best.beta());
  file.write_attribute("layers", static_cast<int>(reports.optimized.layers.size()));
  if (const int passes = setup.settings.layers.passes; passes > 1) file.write_attribute("passes", passes);
  const std::pair<const char*, const SequenceNumbers*> sequences[] = {
      {"optimized/", &reports.optimized},
      {"binary/", &reports.binary},
      {"baseline/", &baseline},
      {"start/", reports.start ? &*reports.start : nullptr}};
  for (const auto& [prefix, numbers] : sequences) {
    if (numbers == nullptr) continue;
    for (const NamedValue& response : numbers->responses)
      file.write_attribute(prefix + response.name, response.value);
  }
  file.close();
  directory.write("result.xdmf", hdf5_xdmf<Dim>(fields, "result.h5"));
}

template <int Dim>
void write_iteration_fields(const Model<Dim>& model, const OutputDirectory& directory,
                            const DumpedIteration& dumped, const Pipeline<Dim>& pipeline,
                            std::span<const double> share, const std::vector<double>& displacement,
                            const BuildFields& checks) {
  const std::vector<double> design = model.design_field(share);
  FieldSet<Dim> fields{&model.grid, {}};
  fields.add_elements("density", model.part.density());
  const PseudoTime<Dim>* last = pipeline.last_time();
  std::vector<double> layer;
  if (last != nullptr) {
    layer = pipeline.last_layer_index();
    fields.add_elements("time", last->time, 1, &model.part.elements());
    fields.add_elements("layer", layer, 1, &model.part.elements());
  }
  add_build_fields(fields, model.part, checks, "");
  fields.add(model.design_support.on_nodes(), "design", design, model.design_support.components());
  if (last != nullptr && !last->temperature.empty()) fields.add_nodes("temperature", last->temperature);
  if (!displacement.empty()) fields.add_nodes("displacement", displacement, Dim);
  directory.make_folder("fields");
  const std::string file = formatted("iteration_%04d", dumped.iteration) + (dumped.failed ? "_failed" : "");
  write_field_dump(model.world(), fields, directory.file("fields/" + file), dumped.iteration);
}

FABSEQ_INSTANTIATE_FUNCTION(write_result);
FABSEQ_INSTANTIATE_FUNCTION(write_iteration_fields);

}  // namespace fabseq
