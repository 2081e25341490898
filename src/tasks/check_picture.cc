// SPDX-License-Identifier: MIT
/// The picture of -task check: elements by the layers of the start design, the plate, node sets. The data are
/// written here; a tool draws them.
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/run_program.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/chain/stages.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/output/task_directory.h"
#include "fabseq/tasks/starting_design.h"
#include "fabseq/tasks/tasks.h"

#include <algorithm>
#include <filesystem>

namespace fabseq {

namespace {

constexpr std::size_t most_nodes = 2000;  ///< of a set: nobody would see more
constexpr double most_seconds = 120.0;    ///< that drawing may take

/// The layer that builds each part element in the start design, 1 to N (a part field). Collective.
template <int Dim>
std::vector<double> start_layers(const Setup<Dim>& setup, const CommandLine& command_line) {
  const auto sequence = make_sequence<Dim>(setup, setup.config.solver.finest_tolerance());
  const Design design = starting_design(setup, *sequence, command_line);
  const std::vector<double>& time = sequence->update(setup.groups.gather(design.field)).time;
  const auto layers = setup.layers->make(design.layer_variables, 0.0, true, {});
  LayerDensities densities;
  layers->set_densities(time, densities);
  return layers->layer_index(time, densities);
}

/// Nodes of a set on all ranks, at most as many as can be seen: their places in the grid, axis by axis.
/// Collective.
template <int Dim>
std::vector<double> places(const Setup<Dim>& setup, const NodeSet& set) {
  std::vector<std::int64_t> own;
  for (const int node : set.owned)
    own.push_back(setup.grid.all_nodes().offset(setup.grid.owned_nodes().index(node)));
  std::vector<std::int64_t> all = gather_all(setup.grid.comm(), own);
  std::sort(all.begin(), all.end());  // the same ones on any number of ranks
  std::vector<double> result;
  const std::size_t step = all.size() / most_nodes + 1;
  for (std::size_t i = 0; i < all.size(); i += step) {
    const Index<Dim> node = setup.grid.all_nodes().index(all[i]);
    result.insert(result.end(), node.begin(), node.end());
  }
  return result;
}

template <int Dim>
void write_data(const Setup<Dim>& setup, const CommandLine& command_line, const std::string& path) {
  const std::vector<double> layer = start_layers(setup, command_line), substrate = setup.substrate_field();
  FieldSet<Dim> fields{&setup.grid, {}};
  fields.add_elements("layer", layer, 1, &setup.part.elements());
  fields.add_elements("substrate", substrate);
  for (auto& field : fields.fields) field.single_precision = true;
  Hdf5Writer file(setup.world(), path);
  file.template write_fields<Dim>(fields);
  file.write_array("spacing", setup.grid.spacing());
  file.write_array("origin", setup.grid.domain().origin);
  file.write_attribute("name", setup.config.name);
  file.write_attribute("unit", setup.config.unit);
  file.write_attribute("plate", setup.config.plate.name());
  for (const auto& [name, set] : setup.node_sets) {
    file.write_array("node_sets/" + name, places(setup, set), Dim);
    file.write_attribute("node_sets/" + name, set.count);
  }
  file.close();
}

/// Has the tool draw, on one rank. Returns why there is no picture; "" if there is.
std::string draw(const std::string& directory, const std::string& picture) {
  const std::string tools = find_tools();
  std::string reason = tools.empty() ? "no fabseq-tools beside the program, in its source tree or on PATH"
                                     : run_program({tools, "plot-check", directory}, most_seconds);
  if (!reason.empty()) remove_quietly(picture);  // of a run before, or half of one
  return reason;
}

}  // namespace

template <int Dim>
void write_check_picture(const Setup<Dim>& setup, const CommandLine& command_line) {
  const std::string directory = place_of_run(setup.config, command_line).directory,
                    picture = directory + "/check.svg";
  run_on_first(setup.world(), [&] {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) throw OutputError("cannot make output directory '" + directory + "': " + error.message());
  });
  write_data(setup, command_line, directory + "/check.h5");
  run_on_first(setup.world(), [&] {
    const std::string reason = draw(directory, picture);
    print("picture: " + (reason.empty() ? picture
                                        : "fabseq-tools plot-check " + directory +
                                              " draws check.svg from check.h5; not drawn now: " + reason));
  });
}

FABSEQ_INSTANTIATE_FUNCTION(write_check_picture);

}  // namespace fabseq
