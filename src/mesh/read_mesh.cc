// SPDX-License-Identifier: MIT
#include "fabseq/mesh/read_mesh.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/verdict.h"

#include <algorithm>
#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <bit>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <span>
#include <utility>

namespace fabseq {

namespace {

using Transformation = aiMatrix4x4t<double>;
constexpr auto most_triangles = static_cast<std::int64_t>(std::numeric_limits<std::int32_t>::max());

/// Sees regular files only: a pipe or a device, whether the mesh or a file that it names, would keep assimp
/// waiting or reading for ever.
class RegularFiles : public Assimp::DefaultIOSystem {
 public:
  // NOLINTBEGIN(readability-identifier-naming): assimp's names
  bool Exists(const char* file) const override {
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored);
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return Exists(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
  }
  // NOLINTEND(readability-identifier-naming)
};

/// Numbers points in the order in which they come; those at the same position have one number.
class PointNumbers {
 public:
  explicit PointNumbers(std::vector<Point<3>>& points) : points_(points), slots_(1 << 10, none) {}

  std::int32_t number_of(const Point<3>& point) {
    if (2 * points_.size() >= slots_.size()) grow();
    std::int32_t& slot = slot_of(point);
    if (slot == none) {
      slot = static_cast<std::int32_t>(points_.size());
      points_.push_back(point);
    }
    return slot;
  }

 private:
  static constexpr std::int32_t none = -1;

  /// The slot with the point's number, or the free one where it belongs.
  std::int32_t& slot_of(const Point<3>& point) {
    std::uint64_t hash = 0;
    for (const double coordinate : point) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(coordinate)) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    const std::size_t mask = slots_.size() - 1;  // the size is a power of two
    std::size_t slot = hash & mask;
    while (slots_[slot] != none && points_[slots_[slot]] != point) slot = (slot + 1) & mask;
    return slots_[slot];
  }

  void grow() {
    slots_.assign(2 * slots_.size(), none);
    for (std::size_t p = 0; p < points_.size(); ++p) slot_of(points_[p]) = static_cast<std::int32_t>(p);
  }

  std::vector<Point<3>>& points_;
  std::vector<std::int32_t> slots_;  ///< hash table of numbers
};

/// Calls f(mesh, transformation) for all meshes of a node and those below it.
void for_each_mesh(const aiScene& scene, const aiNode& node, const Transformation& parent,
                   const std::function<void(const aiMesh&, const Transformation&)>& f) {
  const Transformation transformation = parent * Transformation(node.mTransformation);
  for (unsigned m = 0; m < node.mNumMeshes; ++m) f(*scene.mMeshes[node.mMeshes[m]], transformation);
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    for_each_mesh(scene, *node.mChildren[c], transformation, f);
}

/// Number of a vertex of a scene where its transformation puts it.
std::int32_t number_of(const aiVector3D& vertex, const Transformation& transformation,
                       PointNumbers& numbers) {
  const aiVector3t<double> moved = transformation * aiVector3t<double>(vertex.x, vertex.y, vertex.z);
  const Point<3> point = {moved.x + 0.0, moved.y + 0.0, moved.z + 0.0};  // -0.0 becomes 0.0
  for (const double coordinate : point)
    if (!std::isfinite(coordinate))
      throw InputError("has a point " + to_text<3>(point) + ", needs finite coordinates");
  return numbers.number_of(point);
}

/// Adds the triangles of a mesh of a scene.
void add_triangles(const aiMesh& mesh, const Transformation& transformation, PointNumbers& numbers,
                   TriangleMesh& result) {
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    for (unsigned i = 2; i < face.mNumIndices; ++i) {
      std::array<std::int32_t, 3> triangle;
      const unsigned corners[3] = {face.mIndices[0], face.mIndices[i - 1], face.mIndices[i]};
      for (int c = 0; c < 3; ++c)
        triangle[c] = number_of(mesh.mVertices[corners[c]], transformation, numbers);
      const auto& [p, q, r] = triangle;
      if (p != q && q != r && r != p) result.triangles.push_back(triangle);
    }
  }
}

/// Text of an error of assimp on one line.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

/// Whether the file is PLY with a header that is cut off: assimp 5.2 would look for its end for ever.
bool lacks_end_of_header(const std::string& path) {
  std::string start(1 << 20, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return start.rfind("ply", 0) == 0 && start.find("end_header") == std::string::npos;
}

/// Reads the file on this rank. Errors say what was found and what is needed, not which file it is.
TriangleMesh read_alone(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw InputError("cannot be opened (" + error.message() + "), needs a readable file");
  if (!std::filesystem::is_regular_file(status))
    throw InputError("is a directory, pipe or device, needs a regular file");
  const std::string needs = ", needs an intact STL, OBJ, PLY or 3MF file";
  if (lacks_end_of_header(path)) throw InputError("ends before its header does" + needs);
  const PlainNumbers plain;  // assimp reads some by strtod()
  Assimp::Importer importer;
  importer.SetIOHandler(new RegularFiles);  // becomes the importer's
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw InputError("cannot be read (" + one_line(importer.GetErrorString()) + ")" + needs);
  std::int64_t triangles = 0;
  for_each_mesh(*scene, *scene->mRootNode, {}, [&](const aiMesh& mesh, const Transformation&) {
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
      triangles += std::max<std::int64_t>(static_cast<std::int64_t>(mesh.mFaces[f].mNumIndices) - 2, 0);
  });
  if (triangles > most_triangles)
    throw InputError("has " + std::to_string(triangles) + " triangles, allowed are up to " +
                     std::to_string(most_triangles));
  TriangleMesh result;
  PointNumbers numbers(result.points);
  for_each_mesh(*scene, *scene->mRootNode, {}, [&](const aiMesh& mesh, const Transformation& there) {
    add_triangles(mesh, there, numbers, result);
  });
  if (result.triangles.empty())
    throw InputError("has no triangle, nor a polygon, with corners at different points; needs a surface");
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

}  // namespace

TriangleMesh read_mesh(MPI_Comm comm, const std::string& path, const std::string& key) {
  TriangleMesh result;
  run_on_first(comm, [&] {
    try {
      result = read_alone(path);
    } catch (const InputError& error) {
      throw InputError(key + ": '" + path + "': " + error.what());
    }
  });
  broadcast_entries(comm, result.points);
  broadcast_entries(comm, result.triangles);
  return result;
}

}  // namespace fabseq
