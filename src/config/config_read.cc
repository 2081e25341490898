// SPDX-License-Identifier: MIT
/// Makes a Config from the config file and the command line.
#include "config/named_files.h"
#include "fabseq/base/error.h"
#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/config/command_line.h"
#include "fabseq/config/reslicing.h"
#include "fabseq/keys/config_key.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace fabseq {

namespace {

/// Larger files are no configs.
constexpr std::uintmax_t most_bytes = 64 << 20;

/// Text of the config file.
std::string config_text(const std::string& file) {
  const std::string problem = reading_problem(file);
  if (!problem.empty())
    throw InputError("-config: cannot read " + shown(file) + " (" + problem +
                     "); allowed: a readable JSON file");
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (bytes > most_bytes)
    throw InputError("-config: " + shown(file) + " has " + std::to_string(bytes) +
                     " bytes; allowed: a JSON file of at most 64 MB");
  return read_file_if_there(file);
}

/// What a config file holds, and the absolute directory that its paths refer to. Collective.
std::pair<Json, std::string> read_document(MPI_Comm comm, const std::string& file) {
  std::string text;
  run_on_first(comm, [&] { text = config_text(file); });
  std::error_code error;
  const std::string directory =
      broadcast(comm, std::filesystem::absolute(file, error).parent_path().string());
  return {parse_json(broadcast(comm, text), file), directory};
}

/// Checks that the files that a config names can be read.
void check_files(const Config& config) {
  constexpr const char* allowed = "a readable HDF5 file";
  if (const auto* voxels = std::get_if<VoxelFile>(&config.part.source))
    require_readable("/part/voxels/file", voxels->file, allowed);
  for (const auto& [key, file] : config.sequence.facts.files)
    require_readable(pointer_to("/sequence", key), file, allowed);
}

void warn_about(const Config& config) {
  const ProcessSettings& process = config.process;
  if (process.strain_penalty >= process.stiffness_penalty) return;
  const Json& given = config.effective.at("process");
  warn("/process/strain_penalty: found " + shown(given.at("strain_penalty")) +
       ", less than stiffness_penalty (" + shown(given.at("stiffness_penalty")) +
       "): half-built elements shrink more than they resist");
}

/// The JSON value of a text from the command line; the text itself if it is not JSON.
Json value_of(const std::string& text) {
  try {
    return parse_json(text, "value");
  } catch (const InputError&) {
    return text;
  }
}

/// Index of the list entry that a segment of a path selects, by number or by the "type" of the entry.
std::size_t find_entry(const Json& list, const std::string& segment, const std::string& pointer) {
  const std::size_t count = list.size();
  const auto digit = [](unsigned char character) { return std::isdigit(character) != 0; };
  if (std::all_of(segment.begin(), segment.end(), digit)) {
    const std::size_t index = number_in<std::size_t>(segment).value_or(count);
    if (index < count) return index;
    const std::string allowed =
        count == 0 ? "none, as the list is empty" : "0 to " + std::to_string(count - 1);
    refuse(pointer_to(pointer, segment), "index " + segment, allowed);
  }
  std::vector<std::string> types;
  for (std::size_t i = 0; i < count; ++i) {
    const Json* type = find_member(list[i], "type");
    if (type == nullptr || !type->is_string()) continue;
    if (type->get<std::string>() == segment) return i;
    types.push_back(type->get<std::string>());
  }
  refuse(pointer, "no entry of type " + shown(segment),
         types.empty() ? "an index" : "an index, or one of the types " + join(types, ", "));
}

}  // namespace

void apply_override(Json& document, const std::string& path, const std::string& text) {
  Json* place = &document;
  std::string pointer;
  for (const std::string& segment : split(path, '.')) {
    if (segment.empty()) refuse("-set " + path, "an empty key", "keys joined by single dots");
    if (place->is_array()) {
      const std::size_t index = find_entry(*place, segment, pointer);
      place = &(*place)[index];
      pointer = pointer_to(pointer, index);
      continue;
    }
    if (!place->is_object() && !place->is_null()) {
      refuse(pointer, shown(*place), "an object or a list, for -set " + path);
    }
    place = &(*place)[segment];
    pointer = pointer_to(pointer, segment);
  }
  *place = value_of(text);
}

namespace {

void apply_overrides(Json& document, const CommandLine& command_line) {
  for (const auto& [path, value] : command_line.overrides) apply_override(document, path, value);
}

/// The document of the config file with what the command line says otherwise, and its directory. Collective.
std::pair<Json, std::string> read_overridden(MPI_Comm comm, const CommandLine& command_line) {
  auto result = read_document(comm, command_line.config_file);
  apply_overrides(result.first, command_line);
  return result;
}

}  // namespace

Config read_config(MPI_Comm comm, const CommandLine& command_line) {
  auto [document, directory] = read_document(comm, command_line.config_file);
  return read_config(comm, std::move(document), directory, command_line);
}

Json config_with_machine(MPI_Comm comm, const CommandLine& command_line) {
  auto [document, directory] = read_overridden(comm, command_line);
  merge_machine_file(comm, document, directory);
  return document;
}

NamedSurface read_surface(MPI_Comm comm, const CommandLine& command_line) {
  auto [document, directory] = read_overridden(comm, command_line);
  const Json* name = find_member(document, "name");
  return {name != nullptr && name->is_string() ? name->get<std::string>() : Config().name,
          surface_of_config(comm, document, directory)};
}

Config read_config(MPI_Comm comm, Json document, const std::string& directory,
                   const CommandLine& command_line) {
  apply_overrides(document, command_line);
  std::error_code error;
  std::string sequence_file;
  if (command_line.sequence_file) {
    sequence_file = std::filesystem::absolute(*command_line.sequence_file, error).string();
    apply_override(document, "sequence", Json::object({{"type", "file"}, {"file", sequence_file}}).dump());
    for (const auto& [path, value] : command_line.overrides)
      if (path == "sequence.dataset") apply_override(document, path, value);
  }
  merge_machine_file(comm, document, directory);
  merge_material_file(comm, document, directory);
  const std::shared_ptr<const PlacedMesh> mesh = place_mesh(comm, document, directory);
  Config config = read_settings(document, directory, mesh);
  if (command_line.sequence_file) {
    reslice(command_line, slicing_of(comm, sequence_file), config);
    complete_derived(config);
  } else {
    complete(config);
  }
  check_task(config, command_line.task);
  run_on_first(comm, [&] { check_files(config); });
  warn_about(config);
  return config;
}

}  // namespace fabseq
