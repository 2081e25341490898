// SPDX-License-Identifier: MIT
#include "tasks/write_real_layers.h"

#include "fabseq/base/mpi.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/output/records.h"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

namespace fabseq {

namespace {

/// Numbers of the layers: their volumes, and where they belong.
template <int Dim>
std::vector<LayerNumbers> layer_numbers(const Part<Dim>& part, const RealSequence<Dim>& real) {
  std::vector<double> volumes(static_cast<std::size_t>(real.count), 0.0);
  for (std::size_t e = 0; e < real.layer.size(); ++e)
    volumes[static_cast<std::size_t>(real.layer[e]) - 1] +=
        part.part_density()[e] * part.grid().element_volume();
  sum_in_place(part.grid().comm(), volumes);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<LayerNumbers> result;
  for (const double volume : volumes) {
    const std::size_t layer = result.size();
    result.push_back({volume, unknown, unknown});
    if (real.sub_parts.of_layer.empty()) continue;
    result.back().sub_part = real.sub_parts.of_layer[layer] + 1;
    result.back().slab = real.sub_parts.slab[layer];
  }
  return result;
}

template <int Dim>
Json summary_record(const Setup<Dim>& setup, const RealSequence<Dim>& real, const SequenceReport& report) {
  SequenceNumbers numbers;
  numbers.layers = layer_numbers(setup.part, real);
  numbers.found = report.found;
  numbers.verdict = report.verdict;
  numbers.real_layers = report.real_layers;
  Json record = Json::object({{"name", setup.config.name},
                              {"status", "converged"},
                              {"reason", "real layers, which are not simulated"}});
  add_members(record, numbers, setup.settings);
  for (const char* key : {"displacement", "deposition"}) record.erase(key);
  return record;
}

/// The config, whose sequence is that of the file.
template <int Dim>
Json config_record(const Setup<Dim>& setup, const std::string& result) {
  std::error_code error;
  Json record = setup.effective();
  record["sequence"] = Json::object(
      {{"type", "file"}, {"file", std::filesystem::absolute(result, error).string()}, {"dataset", "time"}});
  record["run"] = Json::object({{"fabseq", FABSEQ_VERSION}, {"ranks", size_of(setup.world())}});
  if (setup.config.part.mesh) record["run"]["mesh_placement"] = setup.config.part.mesh->placement();
  return record;
}

template <int Dim>
void write_fields(const Setup<Dim>& setup, const RealSequence<Dim>& real, const OutputDirectory& directory,
                  const std::string& folder) {
  const std::vector<double> substrate = setup.substrate_field();
  FieldSet<Dim> fields{&setup.grid, {}};
  fields.add_elements("density", setup.part.density());
  if (setup.part.substrate().count() > 0) fields.add_elements("substrate", substrate);
  fields.add_elements("time", real.time.time, 1, &setup.part.elements());
  fields.add_elements("layer", real.layer, 1, &setup.part.elements());
  add_build_fields(fields, setup.part, real.build.fields, "");
  for (auto& field : fields.fields) field.single_precision = field.name != "time";  // the grid is fine
  Hdf5Writer file(setup.world(), directory.file(folder + "result.h5"));
  file.template write_fields<Dim>(fields);
  if (setup.layers->variables().count() > 0) {
    Design design;
    design.layer_variables = real.variables;
    write_layer_variables(file, setup.layers->variables(), "", design);
  }
  file.write_attribute("name", setup.config.name);
  file.write_attribute("layers", real.count);
  file.close();
  directory.write(folder + "result.xdmf", hdf5_xdmf<Dim>(fields, "result.h5"));
}

}  // namespace

template <int Dim>
void write_real_layers(const BeadChecks<Dim>& beads, const RealSequence<Dim>& real,
                       const SequenceReport& report, const OutputDirectory& directory) {
  const Setup<Dim>& setup = beads.for_bodies();
  const std::string folder = std::string(beads_folder) + "/";
  directory.make_folder(beads_folder);
  directory.write(folder + "config.json",
                  to_text(config_record(setup, directory.file(folder + "result.h5")), 2) + "\n");
  write_fields(setup, real, directory, folder);
  directory.write(folder + "summary.json", to_text(summary_record(setup, real, report), 2) + "\n");
}

FABSEQ_INSTANTIATE_FUNCTION(write_real_layers);

}  // namespace fabseq
