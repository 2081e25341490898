// SPDX-License-Identifier: MIT
#include "fabseq/config/reslicing.h"

#include "fabseq/base/hdf5.h"
#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/files/hdf5_attribute.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <filesystem>
#include <optional>

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

bool needs_gradient(const Json& term, TermList list) {
  const Json* type = find_member(term, "type");
  if (type == nullptr || !type->is_string()) return false;
  const ResponseType* known = find_response_type(list, type->get<std::string>());
  return known != nullptr && known->layers != LayerKind::multi_planar && known->needs_time_gradient;
}

void leave_out_terms_of_gradient(Json& document, TermList list) {
  const std::string name = list == TermList::objective ? "objective" : "constraints";
  Json* terms = find_member(document, name);
  if (terms == nullptr || !terms->is_array()) return;
  Json kept = Json::array();
  for (std::size_t i = 0; i < terms->size(); ++i) {
    const Json& term = (*terms)[i];
    if (needs_gradient(term, list)) {
      warn("-sequence: " + pointer_to(pointer_to("", name), i) + " (" + term.at("type").get<std::string>() +
           ") is left out: it needs the gradient of the pseudo-time, which a file does not have");
    } else {
      kept.push_back(term);
    }
  }
  *terms = kept;
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

void reslice(MPI_Comm comm, const CommandLine& command_line, Json& document) {
  if (!command_line.sequence_file) return;
  std::error_code error;
  const std::string file = std::filesystem::absolute(*command_line.sequence_file, error).string();
  const Slicing of_file = slicing_of(comm, file);
  document["sequence"] = Json::object({{"type", "file"}, {"file", file}});
  const Json* type = find_member(document, "layers", "type");
  const bool has_sub_parts = type != nullptr && *type == "multi_planar";  // which have no layers.count
  if (of_file.layers > 0.0 && !is_given(command_line, "layers.count") && !has_sub_parts)
    apply_override(document, "layers.count", std::to_string(static_cast<int>(of_file.layers)));
  const Json* count = find_member(document, "layers", "count");
  const bool known = of_file.layers > 0.0 && of_file.beta > 0.0 && count != nullptr && count->is_number();
  if (known && !is_given(command_line, "projection.beta")) {
    const double beta = of_file.beta * (count->get<double>() / of_file.layers);
    apply_override(document, "projection.beta", Json(beta).dump());
    apply_override(document, "projection.max", Json(beta).dump());
  }
  leave_out_terms_of_gradient(document, TermList::objective);
  leave_out_terms_of_gradient(document, TermList::constraints);
}

}  // namespace fabseq
