// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "mesh/mesh_formats.h"

#include <algorithm>
#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <filesystem>
#include <set>
#include <utility>

namespace fabseq {

namespace {

using Transformation = aiMatrix4x4t<double>;

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

/// assimp would try some forty formats: damaged files of others than these two crash it.
void keep_stl_and_obj(Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* loader = importer.GetImporter(i);
    std::set<std::string> extensions;
    loader->GetExtensionList(extensions);
    if (extensions.contains("stl") || extensions.contains("obj")) continue;
    if (importer.UnregisterLoader(loader) == aiReturn_SUCCESS) delete loader;
  }
}

/// Adds the meshes of a node and of those below it.
void add_node(const aiScene& scene, const aiNode& node, const Transformation& parent,
              SurfaceBuilder& surface) {
  const Transformation transformation = parent * Transformation(node.mTransformation);
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    std::vector<Point<3>> vertices(mesh.mNumVertices);
    std::transform(mesh.mVertices, mesh.mVertices + mesh.mNumVertices, vertices.begin(),
                   [&](const aiVector3D& vertex) {
                     const auto moved = transformation * aiVector3t<double>(vertex.x, vertex.y, vertex.z);
                     return Point<3>{moved.x, moved.y, moved.z};
                   });
    surface.begin(std::move(vertices));
    std::vector<std::int64_t> corners;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      corners.assign(face.mIndices, face.mIndices + face.mNumIndices);
      surface.add_polygon(corners);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    add_node(scene, *node.mChildren[c], transformation, surface);
}

/// Text of an error of assimp on one line.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

}  // namespace

void read_stl_or_obj(const std::string& path, SurfaceBuilder& surface) {
  Assimp::Importer importer;
  keep_stl_and_obj(importer);
  importer.SetIOHandler(new RegularFiles);  // becomes the importer's
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw InputError("cannot be read (" + one_line(importer.GetErrorString()) +
                     "), needs an intact STL, OBJ, PLY or 3MF file");
  add_node(*scene, *scene->mRootNode, {}, surface);
}

}  // namespace fabseq
