// SPDX-License-Identifier: MIT
#include "config/named_files.h"
#include "config/named_json.h"
#include "fabseq/base/refusal.h"

#include <filesystem>

namespace fabseq {

namespace {

constexpr const char* pointer = "/material/file";

}  // namespace

void merge_material_file(MPI_Comm comm, Json& document, const std::string& directory) {
  const Json* file = find_member(document, "material", "file");
  if (file == nullptr) return;
  if (!file->is_string()) refuse(pointer, shown(*file), "a file name");
  const std::string path =
      (std::filesystem::path(directory) / file->get<std::string>()).lexically_normal().string();
  Json material = read_named_json(comm, pointer, path);
  if (material.contains("file"))
    refuse(pointer, shown(path) + ", which names another file", "a file with a material's values");
  for (const char* words : {"source", "comment"}) material.erase(words);
  document["material"].erase("file");
  material.update(document["material"]);
  document["material"] = material;
}

}  // namespace fabseq
