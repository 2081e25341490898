// SPDX-License-Identifier: MIT
#include "fabseq/config/reslicing.h"

#include "fabseq/base/hdf5.h"
#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/files/hdf5_attribute.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace fabseq {

namespace {

double positive_attribute(hid_t file, const std::string& name) {
  const std::optional<Json> value = read_attribute(file, name);
  return value && value->is_number() ? std::max(0.0, value->get<double>()) : 0.0;
}

bool is_given(const CommandLine& command_line, const std::string& path) {
  return std::any_of(command_line.overrides.begin(), command_line.overrides.end(),
                     [&](const auto& setting) { return setting.first == path; });
}

/// Why a sequence from a file has no such response; empty if it has.
std::string obstacle_to(const ResponseType& type, const Config& config) {
  if (config.needs_time_gradient(type))
    return "it needs the gradient of the pseudo-time, which a sequence from a file has for checks only";
  return config.has_layers_of(type) ? "" : "it is for layers of type " + name_of(type.layers);
}

void leave_out_terms(const Config& config, std::vector<Term>& terms, const std::string& list) {
  std::erase_if(terms, [&](const Term& term) {
    const std::string why = obstacle_to(*term.type, config);
    if (why.empty()) return false;
    warn("-sequence: " + pointer_to(pointer_to("", list), term.position) + " (" + term.type->name +
         ") is left out: " + why);
    return true;
  });
}

/// Settles layers.count and layers.passes for so many real layers. `of_file`: number of layers of the file.
void share_out_real_layers(const CommandLine& command_line, int of_file, int real, Config& config) {
  LayerSettings& layers = config.layers;
  const bool has_count = is_given(command_line, "layers.count");
  const bool has_passes = is_given(command_line, "layers.passes");
  if (has_passes && !has_count && real % layers.passes != 0)
    refuse("/layers/passes",
           shown(layers.passes) + " with -sequence of " + std::to_string(real) + " real layers",
           "a number that divides them, or one with layers.count");
  if (!has_count) layers.count = has_passes ? real / layers.passes : of_file;
  if (has_passes || !layers.count || real == of_file) return;
  // Heat that counted as many passes as the config's layers goes on to do so.
  if (config.thermal && config.thermal->given_passes == layers.passes) config.thermal->given_passes.reset();
  layers.passes = real % *layers.count == 0 ? real / *layers.count : 1;
}

}  // namespace

Slicing slicing_of(MPI_Comm comm, const std::string& name) {
  silence_hdf5();
  Slicing found;
  double passes = 0.0;
  if (rank_of(comm) == 0 && reading_problem(name).empty()) {
    const Hdf5File file(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    if (file) {
      found = {positive_attribute(file, "layers"), positive_attribute(file, "beta")};
      passes = positive_attribute(file, "passes");
    }
  }
  return {max(comm, found.layers), max(comm, found.beta), static_cast<int>(max(comm, passes))};
}

void reslice(const CommandLine& command_line, const Slicing& of_file, Config& config) {
  LayerSettings& layers = config.layers;
  const auto target = target_thickness(config);
  const int file_layers = static_cast<int>(of_file.layers);
  const int real = file_layers * (of_file.passes > 0 ? of_file.passes : layers.passes);
  if (file_layers > 0 && !layers.multi_planar) share_out_real_layers(command_line, file_layers, real, config);
  const bool known = of_file.layers > 0.0 && of_file.beta > 0.0 && layers.count;
  if (known && !is_given(command_line, "projection.beta")) {
    config.projection.beta = of_file.beta * (*layers.count / of_file.layers);
    config.projection.max = config.projection.beta;
  }
  leave_out_terms(config, config.objective, "objective");
  leave_out_terms(config, config.constraints, "constraints");
  if (!target || layers.multi_planar) return;
  const bool is_resliced = file_layers > 0 && layers.count;
  const double layer =
      target->bead * (is_resliced ? static_cast<double>(real) / *layers.count : layers.passes);
  layers.given_target = layer / layers.passes;
}

}  // namespace fabseq
