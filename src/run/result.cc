// SPDX-License-Identifier: MIT
#include "fabseq/run/result.h"

#include "fabseq/files/hdf5_writer.h"
#include "fabseq/files/xdmf.h"
#include "fabseq/run/layer_variable_output.h"

namespace fabseq {

template <int Dim>
void write_result(const Setup<Dim>& setup, const OutputDirectory& directory, const FinalReports<Dim>& reports,
                  const SequenceReport<Dim>& baseline, const BestIterate& best) {
  const std::vector<double> design = setup.design_field(best.design().field);
  const std::vector<double> substrate = setup.substrate_field();
  FieldSet<Dim> fields;
  fields.grid = &setup.grid;
  fields.add_elements("density", setup.part.density());
  if (setup.part.substrate().count() > 0) fields.add_elements("substrate", substrate);
  fields.add(setup.design_support.on_nodes(), "design", design);
  reports.optimized.add_fields(fields, "");
  fields.add_nodes("binary/displacement", reports.binary.displacement, Dim);
  baseline.add_fields(fields, "planar/");
  Hdf5Writer file(setup.world(), directory.file("result.h5"));
  file.template write_fields<Dim>(fields);
  write_layer_variables(file, setup.layers->variables(), "", best.design());
  file.write_attribute("name", setup.config.name);
  file.write_attribute("iteration", best.iteration());
  file.write_attribute("beta", best.beta());
  file.write_attribute("layers", static_cast<int>(reports.optimized.layers.size()));
  const std::pair<const char*, const SequenceNumbers*> sequences[] = {
      {"optimized/", &reports.optimized}, {"binary/", &reports.binary}, {"baseline/", &baseline}};
  for (const auto& [prefix, numbers] : sequences)
    for (const NamedValue& response : numbers->responses)
      file.write_attribute(prefix + response.name, response.value);
  file.close();
  directory.write("result.xdmf", hdf5_xdmf<Dim>(fields, "result.h5"));
}

FABSEQ_INSTANTIATE_FUNCTION(write_result);

}  // namespace fabseq
