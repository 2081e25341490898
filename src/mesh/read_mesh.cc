// SPDX-License-Identifier: MIT
#include "fabseq/mesh/read_mesh.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/mesh/length_units.h"
#include "mesh/mesh_formats.h"
#include "mesh/other_formats.h"
#include "mesh/shells.h"
#include "mesh/stray_triangles.h"
#include "mesh/text_values.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
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

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError("cannot be opened, needs a readable file");
  std::string bytes(static_cast<std::size_t>(std::filesystem::file_size(path)), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// Coordinates that have single precision and lie far from the origin have lost digits that the mesh needs.
void note_lost_digits(const TriangleMesh& mesh, std::vector<std::string>& notes) {
  constexpr double tolerated = 1e-4;  // of the extent
  constexpr auto next = static_cast<double>(std::numeric_limits<float>::epsilon());
  double farthest = 0.0, extent = 0.0;
  const Bounds box = bounds(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    farthest = std::max({farthest, std::abs(box.low[axis]), std::abs(box.high[axis])});
    extent = std::max(extent, box.high[axis] - box.low[axis]);
  }
  const bool coarse = std::isfinite(farthest) && farthest * next > tolerated * extent;
  const auto is_single = [](const Point<3>& point) {
    return std::all_of(point.begin(), point.end(),
                       [](double x) { return x == static_cast<double>(static_cast<float>(x)); });
  };
  if (coarse && std::all_of(mesh.points.begin(), mesh.points.end(), is_single))
    notes.push_back(formatted(
        "coordinates up to %.3g in single precision are %.2g apart, in a mesh of %.3g: move it to the origin "
        "before it is exported",
        farthest, farthest * next, extent));
}

/// Reads the file on this rank. Errors say what was found and what is needed, not which file it is.
TriangleMesh read_format(const std::string& path, ThreeMfObjects wanted, std::vector<std::string>& notes,
                         std::string& unit) {
  std::string bytes = bytes_of(path);
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  if (bytes.starts_with("PK\3\4")) return read_three_mf(std::move(bytes), wanted, notes, unit);
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return read_ply(bytes);
  const std::string needs = "needs an intact STL, OBJ, PLY or 3MF file";
  if (extension == ".obj" && looks_like_obj(bytes)) return read_obj(bytes);
  if (looks_like_stl(bytes, false)) return read_stl(bytes, notes);
  const std::string other = other_format(bytes);
  if (!other.empty()) throw InputError("is " + other + "; " + needs);
  if (looks_like_stl(bytes, extension == ".stl")) return read_stl(bytes, notes);
  if (extension == ".obj" || looks_like_obj(bytes)) return read_obj(bytes);
  const std::string named = format_by_ending(extension);
  throw InputError(named.empty() ? "is no surface that can be read, " + needs : "is " + named + "; " + needs);
}

/// The factor from the unit of a file, if its format names one, to that of the config.
double unit_factor(const std::string& stated, const std::string& wanted, std::vector<std::string>& notes) {
  const std::optional<double> from = metres_in(stated), to = metres_in(wanted);
  if (!from) return 1.0;
  const std::string is_in = "is in " + stated + ", ";
  const bool same = to && std::abs(*from / *to - 1.0) < 1e-12;
  if (same || (!to && stated == "millimeter")) return 1.0;
  if (to)
    notes.push_back(is_in + "converted to " + wanted);
  else
    notes.push_back(is_in +
                    "but domain.unit names no unit of length: its coordinates are taken as they stand");
  return to ? *from / *to : 1.0;
}

/// Reads the file on this rank, with lengths in `unit`.
ReadMesh read_alone(const std::string& path, ThreeMfObjects wanted, const std::string& unit,
                    std::vector<std::string>& notes) {
  require_regular_file(path);
  std::string unit_of_file;
  ReadMesh result;
  result.mesh = read_format(path, wanted, notes, unit_of_file);
  note_lost_digits(result.mesh, notes);
  result.unit_factor = unit_factor(unit_of_file, unit, notes);
  if (result.unit_factor != 1.0)
    for (Point<3>& point : result.mesh.points)
      for (double& coordinate : point) coordinate *= result.unit_factor;
  return result;
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

/// read_mesh(), where rank 0 calls prepare(mesh, notes) before the other ranks get the mesh.
template <class Prepare>
ReadMesh read_and_prepare(MPI_Comm comm, const std::string& path, const std::string& key,
                          const std::string& unit, ThreeMfObjects wanted, const Prepare& prepare) {
  ReadMesh result;
  run_on_first(comm, [&] {
    const std::string file = key + ": '" + path + "': ";
    try {
      std::vector<std::string> notes;
      result = read_alone(path, wanted, unit, notes);
      prepare(result.mesh, notes);
      for (const std::string& note : notes) warn(MPI_COMM_SELF, file + note);
    } catch (const InputError& error) {
      throw InputError(file + error.what());
    }
  });
  broadcast_entries(comm, result.mesh.points);
  broadcast_entries(comm, result.mesh.triangles);
  broadcast(comm, std::span(&result.unit_factor, 1));
  return result;
}

}  // namespace

ReadMesh read_mesh(MPI_Comm comm, const std::string& path, const std::string& key, const std::string& unit) {
  return read_and_prepare(comm, path, key, unit, ThreeMfObjects::surfaces_too,
                          [](TriangleMesh&, std::vector<std::string>&) {});
}

ReadMesh read_body(MPI_Comm comm, const std::string& path, const std::string& key, const std::string& unit) {
  const auto prepare = [](TriangleMesh& mesh, std::vector<std::string>& notes) {
    for (const auto& step : {remove_stray_triangles, turn_shells})
      for (std::string& note : step(mesh)) notes.push_back(std::move(note));
  };
  return read_and_prepare(comm, path, key, unit, ThreeMfObjects::bodies, prepare);
}

}  // namespace fabseq
