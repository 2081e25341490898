// SPDX-License-Identifier: MIT
#include "fabseq/config/reslicing.h"

#include "fabseq/base/hdf5.h"
#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
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

void leave_out_terms_of_gradient(std::vector<Term>& terms, const std::string& list) {
  std::erase_if(terms, [&](const Term& term) {
    const ResponseType& type = *term.type;
    if (!type.needs_time_gradient) return false;
    warn("-sequence: " + pointer_to(pointer_to("", list), term.position) + " (" + type.name +
         ") is left out: it needs the gradient of the pseudo-time, which a sequence from a file has for "
         "checks only");
    return true;
  });
}

}  // namespace

Slicing slicing_of(MPI_Comm comm, const std::string& name) {
  silence_hdf5();
  Slicing found;
  if (rank_of(comm) == 0 && reading_problem(name).empty()) {
    const Hdf5File file(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    if (file) found = {positive_attribute(file, "layers"), positive_attribute(file, "beta")};
  }
  return {max(comm, found.layers), max(comm, found.beta)};
}

void reslice(const CommandLine& command_line, const Slicing& of_file, Config& config) {
  LayerSettings& layers = config.layers;
  if (of_file.layers > 0.0 && !is_given(command_line, "layers.count") && !layers.multi_planar)
    layers.count = static_cast<int>(of_file.layers);
  const bool known = of_file.layers > 0.0 && of_file.beta > 0.0 && layers.count;
  if (known && !is_given(command_line, "projection.beta")) {
    config.projection.beta = of_file.beta * (*layers.count / of_file.layers);
    config.projection.max = config.projection.beta;
  }
  const auto target = target_thickness(config);
  leave_out_terms_of_gradient(config.objective, "objective");
  leave_out_terms_of_gradient(config.constraints, "constraints");
  if (!target || layers.multi_planar) return;
  const bool is_resliced = of_file.layers > 0.0 && layers.count;
  layers.given_target = target->value * (is_resliced ? of_file.layers / *layers.count : 1.0);
}

}  // namespace fabseq
