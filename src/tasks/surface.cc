// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/tasks/tasks.h"

#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>

namespace fabseq {

namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void append(std::string& text, const T& value) {
  text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// PLY in double precision.
std::string ply_of(const TriangleMesh& mesh) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.points.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  text.reserve(text.size() + 24 * mesh.points.size() + 13 * mesh.triangles.size());
  for (const Point<3>& point : mesh.points) append(text, point);
  for (const auto& triangle : mesh.triangles) {
    text += '\3';
    append(text, triangle);
  }
  return text;
}

}  // namespace

void write_surface(MPI_Comm world, const CommandLine& command_line) {
  const auto [name, surface] = read_surface(world, command_line);
  const std::string directory = command_line.output.value_or("output/" + name);
  run_on_first(world, [&, &mesh = surface.mesh] {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) throw OutputError("cannot make output directory '" + directory + "': " + error.message());
    replace_file(directory + "/surface.ply", ply_of(mesh));
    print("surface: " + std::to_string(mesh.triangles.size()) + " triangles in " + directory +
          "/surface.ply");
  });
}

}  // namespace fabseq
