// SPDX-License-Identifier: MIT
#include "fabseq/mesh/read_mesh.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "mesh/mesh_formats.h"
#include "mesh/shells.h"
#include "mesh/stray_triangles.h"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <utility>

namespace fabseq {

namespace {

/// Throws InputError for what is no regular file: reading it might never end.
void require_regular_file(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw InputError("cannot be opened (" + error.message() + "), needs a readable file");
  if (!std::filesystem::is_regular_file(status))
    throw InputError("is a directory, pipe or device, needs a regular file");
}

/// The first bytes of a file, which say more about its format than its name does.
std::string first_bytes(const std::string& path) {
  std::string start(4, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return start;
}

/// Reads the file on this rank. Errors say what was found and what is needed, not which file it is.
TriangleMesh read_alone(const std::string& path, std::vector<std::string>& notes) {
  require_regular_file(path);
  const PlainNumbers plain;  // assimp and lib3mf read some by strtod()
  SurfaceBuilder surface;
  const std::string start = first_bytes(path);
  if (start == "PK\3\4")
    notes = read_three_mf(path, surface);
  else if (start == "ply\n" || start == "ply\r")
    read_ply(path, surface);
  else
    read_stl_or_obj(path, surface);
  return surface.take();
}

/// Copies rank 0's entries to all ranks. Collective.
template <class T>
void broadcast_entries(MPI_Comm comm, std::vector<T>& entries) {
  auto count = static_cast<std::int64_t>(entries.size());
  MPI_Bcast(&count, 1, MPI_INT64_T, 0, comm);
  entries.resize(static_cast<std::size_t>(count));
  for_each_message(std::as_writable_bytes(std::span(entries)), [comm](std::span<std::byte> part) {
    MPI_Bcast(part.data(), static_cast<int>(part.size()), MPI_BYTE, 0, comm);
  });
}

}  // namespace

namespace {

/// read_mesh(), where rank 0 calls prepare(mesh, notes) before the other ranks get the mesh.
template <class Prepare>
TriangleMesh read_and_prepare(MPI_Comm comm, const std::string& path, const std::string& key,
                              const Prepare& prepare) {
  TriangleMesh result;
  run_on_first(comm, [&] {
    const std::string file = key + ": '" + path + "': ";
    try {
      std::vector<std::string> notes;
      result = read_alone(path, notes);
      prepare(result, notes);
      for (const std::string& note : notes) warn(MPI_COMM_SELF, file + note);
    } catch (const InputError& error) {
      throw InputError(file + error.what());
    }
  });
  broadcast_entries(comm, result.points);
  broadcast_entries(comm, result.triangles);
  return result;
}

}  // namespace

TriangleMesh read_mesh(MPI_Comm comm, const std::string& path, const std::string& key) {
  return read_and_prepare(comm, path, key, [](TriangleMesh&, std::vector<std::string>&) {});
}

TriangleMesh read_body(MPI_Comm comm, const std::string& path, const std::string& key) {
  return read_and_prepare(comm, path, key, [](TriangleMesh& mesh, std::vector<std::string>& notes) {
    for (const auto& step : {remove_stray_triangles, turn_shells})
      for (std::string& note : step(mesh)) notes.push_back(std::move(note));
  });
}

}  // namespace fabseq
