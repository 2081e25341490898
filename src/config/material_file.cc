// SPDX-License-Identifier: MIT
#include "fabseq/config/material_file.h"

#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/refusal.h"
#include "fabseq/keys/message.h"

#include <filesystem>

namespace fabseq {

namespace {

constexpr const char* pointer = "/material/file";
constexpr const char* allowed = "a readable file with a JSON object of at most 1 MB";
constexpr std::uintmax_t largest_material = 1 << 20;

/// What is wrong with the file; empty: nothing.
std::string problem_of(const std::string& path) {
  std::string problem = reading_problem(path);
  if (!problem.empty()) return shown(path) + ", which cannot be read (" + problem + ")";
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return bytes > largest_material ? shown(path) + ", which has " + std::to_string(bytes) + " bytes" : "";
}

Json read_material(MPI_Comm comm, const std::string& path) {
  std::string problem, text;
  if (rank_of(comm) == 0) {
    problem = problem_of(path);
    if (problem.empty()) text = read_file_if_there(path);
  }
  problem = broadcast(comm, problem);
  if (!problem.empty()) refuse(pointer, problem, allowed);
  Json material = parse_json(broadcast(comm, text), path);
  if (!material.is_object()) refuse(pointer, shown(path) + ", which holds no object", allowed);
  if (material.contains("file")) refuse(pointer, shown(path) + ", which names another file", allowed);
  return material;
}

}  // namespace

void merge_material_file(MPI_Comm comm, Json& document, const std::string& directory) {
  const Json* given = find_member(document, "material");
  const Json* file = given != nullptr ? find_member(*given, "file") : nullptr;
  if (file == nullptr) return;
  if (!file->is_string()) refuse(pointer, shown(*file), "a file name");
  const auto path = std::filesystem::path(directory) / file->get<std::string>();
  Json material = read_material(comm, path.lexically_normal().string());
  for (const char* words : {"source", "comment"}) material.erase(words);
  Json own = *given;
  own.erase("file");
  for (const auto& [name, value] : own.items()) material[name] = value;
  document["material"] = material;
}

}  // namespace fabseq
