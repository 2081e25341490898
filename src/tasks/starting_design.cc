// SPDX-License-Identifier: MIT
#include "fabseq/tasks/starting_design.h"

#include "fabseq/base/error.h"
#include "fabseq/base/hdf5.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/layers/curved_layers.h"
#include "fabseq/sequence/sequence_kind.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace fabseq {

namespace {

/// Whether the file has values of a kind; says so if not.
bool has_values(MPI_Comm comm, const std::string& file, const std::string& dataset) {
  const bool found = hdf5_file_has(comm, file, dataset, "-design");
  if (!found) warn("-design: '" + file + "' has no dataset '" + dataset + "': the initial values are taken");
  return found;
}

bool any_outside(MPI_Comm comm, const std::vector<double>& values, double lower, double upper) {
  constexpr double rounding = 1e-9;
  const double below = lower - rounding * std::abs(lower), above = upper + rounding * std::abs(upper);
  return any(comm, std::any_of(values.begin(), values.end(),
                               [&](double value) { return !(value >= below && value <= above); }));
}

/// `design`: values on the owned elements or nodes with a variable; `file` has them.
template <int Dim>
void require_field(const Setup<Dim>& setup, const DesignSpace& space, const std::vector<double>& design,
                   const std::string& file) {
  const std::string& key = setup.config.sequence.kind->bounds_key;
  for (int component = 0; component < space.count(); ++component) {
    std::vector<double> values;
    for (std::size_t i = component; i < design.size(); i += space.count()) values.push_back(design[i]);
    const auto& [lower, upper, logarithmic] = space.components[component];
    if (!any_outside(setup.world(), values, lower, upper)) continue;
    throw InputError("-design: " + file + " has values outside the bounds " + Json(lower).dump() + " to " +
                     Json(upper).dump() +
                     (space.count() > 1 ? " of component " + std::to_string(component) : "") +
                     (key.empty() ? "" : " of " + pointer_to("/sequence", key)) + " on the part's " +
                     (setup.design_support.on_nodes() ? "nodes" : "elements"));
  }
}

/// Values on the owned elements or nodes with a variable.
template <int Dim>
std::vector<double> read_design_field(const Setup<Dim>& setup, const DesignSpace& space,
                                      const std::string& file) {
  const DesignSupport<Dim>& support = setup.design_support;
  std::vector<double> design = support.restrict_to_variables(
      read_field(setup.grid, support.on_nodes(), file, "design", "-design", "-design", space.count()));
  require_field(setup, space, design, file);
  return design;
}

void require_layer_variables(MPI_Comm comm, const LayerVariables& variables,
                             const std::vector<double>& values, const std::string& file,
                             const std::string& option) {
  for (std::size_t j = 0; j < values.size(); ++j)
    if (any_outside(comm, {values[j]}, variables.lower[j], variables.upper[j]))
      throw InputError(option + ": dataset '" + variables.name + "' of " + file + " has " +
                       Json(values[j]).dump() + ", outside " + Json(variables.lower[j]).dump() + " to " +
                       Json(variables.upper[j]).dump());
  if (variables.columns == 0 && !std::is_sorted(values.begin(), values.end()))
    throw InputError(option + ": dataset '" + variables.name + "' of " + file + " has " +
                     shown(Json(values)) + ", needs ascending times");
}

std::vector<double> read_layer_variables(MPI_Comm comm, const LayerVariables& variables,
                                         const std::string& file, const std::string& option) {
  const char* shape = variables.columns > 0 ? "a row a sub-part" : "one less than layers";
  std::vector<double> result =
      read_list(comm, file, variables.name, variables.count(), shape, option, option, variables.columns);
  require_layer_variables(comm, variables, result, file, option);
  return result;
}

/// T_1 ... T_{N-1} of -sequence: those of the file, which may have another number of layers, at equal steps
/// between them. The same ones for the same number; uniform ones where the file has none.
std::vector<double> resliced_time_points(MPI_Comm comm, int layers, const std::string& file) {
  std::vector<double> given;
  if (hdf5_file_has(comm, file, "time_points", "-sequence"))
    given = read_list(comm, file, "time_points", "-sequence", "-sequence");
  return interpolated_time_points(given, layers);
}

/// The file of -sequence, or that of a sequence of type "file", as in the config.json that -sequence leaves.
std::optional<std::string> sequence_file(const Config& config, const CommandLine& command_line) {
  if (command_line.sequence_file) return command_line.sequence_file;
  if (config.sequence.kind->name != "file" || config.sequence.facts.files.empty()) return std::nullopt;
  return config.sequence.facts.files.front().second;
}

}  // namespace

template <int Dim>
Design starting_design(const Setup<Dim>& setup, const Sequence<Dim>& sequence,
                       const CommandLine& command_line) {
  const LayerVariables& variables = setup.layers->variables();
  const std::optional<std::string> file = sequence_file(setup.config, command_line);
  const auto has = [&](const char* dataset) {
    return command_line.design_file && has_values(setup.world(), *command_line.design_file, dataset);
  };
  Design design;
  if (sequence.has_design())
    design.field = setup.groups.share(
        has("design") ? read_design_field(setup, sequence.space(), *command_line.design_file)
                      : sequence.initial_design());
  design.layer_variables = variables.start;
  if (variables.count() > 0 && has(variables.name.c_str())) {
    design.layer_variables =
        read_layer_variables(setup.world(), variables, *command_line.design_file, "-design");
  } else if (setup.config.layers.variable_time_points && file) {
    design.layer_variables = resliced_time_points(setup.world(), setup.layers->count(), *file);
  } else if (variables.count() > 0 && file &&
             hdf5_file_has(setup.world(), *file, variables.name, "-sequence")) {
    design.layer_variables = read_layer_variables(setup.world(), variables, *file, "-sequence");
  }
  return design;
}

template <int Dim>
void require_within_bounds(const Setup<Dim>& setup, const Sequence<Dim>& sequence, const FirstDesign& given) {
  const auto& [design, file] = given;
  require_field(setup, sequence.space(), setup.groups.gather(design.field), file);
  require_layer_variables(setup.world(), setup.layers->variables(), design.layer_variables, file, "-design");
}

FABSEQ_INSTANTIATE_FUNCTION(starting_design);
FABSEQ_INSTANTIATE_FUNCTION(require_within_bounds);

}  // namespace fabseq
