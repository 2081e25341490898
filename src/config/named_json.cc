// SPDX-License-Identifier: MIT
#include "config/named_json.h"

#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/verdict.h"

#include <filesystem>

namespace fabseq {

namespace {

constexpr const char* allowed = "a readable file with a JSON object of at most 1 MB";
constexpr std::uintmax_t most_bytes = 1 << 20;

/// Text of the file. Throws InputError.
std::string text_of_file(const std::string& pointer, const std::string& path) {
  require_readable(pointer, path, allowed);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (bytes > most_bytes)
    refuse(pointer, shown(path) + ", which has " + std::to_string(bytes) + " bytes", allowed);
  return read_file_if_there(path);
}

}  // namespace

Json read_named_json(MPI_Comm comm, const std::string& pointer, const std::string& path) {
  std::string text;
  run_on_first(comm, [&] { text = text_of_file(pointer, path); });
  Json result = parse_json(broadcast(comm, text), path);
  if (!result.is_object()) refuse(pointer, shown(path) + ", which holds no object", allowed);
  return result;
}

}  // namespace fabseq
