// SPDX-License-Identifier: MIT
#include "config/named_files.h"
#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/verdict.h"

#include <filesystem>

namespace fabseq {

namespace {

constexpr const char* pointer = "/material/file";
constexpr const char* allowed = "a readable file with a JSON object of at most 1 MB";
constexpr std::uintmax_t largest_material = 1 << 20;

/// Text of the file. Throws InputError.
std::string material_text(const std::string& path) {
  require_readable(pointer, path, allowed);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (bytes > largest_material)
    refuse(pointer, shown(path) + ", which has " + std::to_string(bytes) + " bytes", allowed);
  return read_file_if_there(path);
}

Json read_material(MPI_Comm comm, const std::string& path) {
  std::string text;
  run_on_first(comm, [&] { text = material_text(path); });
  Json material = parse_json(broadcast(comm, text), path);
  if (!material.is_object()) refuse(pointer, shown(path) + ", which holds no object", allowed);
  if (material.contains("file")) refuse(pointer, shown(path) + ", which names another file", allowed);
  return material;
}

}  // namespace

void merge_material_file(MPI_Comm comm, Json& document, const std::string& directory) {
  const Json* file = find_member(document, "material", "file");
  if (file == nullptr) return;
  if (!file->is_string()) refuse(pointer, shown(*file), "a file name");
  const auto path = std::filesystem::path(directory) / file->get<std::string>();
  Json material = read_material(comm, path.lexically_normal().string());
  for (const char* words : {"source", "comment"}) material.erase(words);
  document["material"].erase("file");
  material.update(document["material"]);
  document["material"] = material;
}

}  // namespace fabseq
