// SPDX-License-Identifier: MIT
#include "mesh/object_volumes.h"

#include "mesh/cut_out.h"
#include "mesh/hole_groups.h"
#include "mesh/shells.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

void add_mesh(TriangleMesh mesh, SurfaceBuilder& surface) {
  surface.begin(std::move(mesh.points));
  for (const auto& [a, b, c] : mesh.triangles) surface.add_polygon(std::array<std::int64_t, 3>{a, b, c});
}

std::string counted(int count, const char* words) {
  return std::to_string(count) + " negative volume" + (count == 1 ? " " : "s ") + words;
}

}  // namespace

void ObjectVolumes::add(bool negative, const std::vector<Point<3>>& vertices,
                        std::span<const std::array<std::int64_t, 3>> triangles) {
  if (volumes_.empty() || negative || volumes_.back().negative) volumes_.emplace_back().negative = negative;
  Volumes& volumes = volumes_.back();
  volumes.surface.begin(vertices);
  for (const auto& triangle : triangles) volumes.surface.add_polygon(triangle);
}

void ObjectVolumes::build(SurfaceBuilder& surface, std::vector<std::string>& notes) {
  std::vector<TriangleMesh> meshes;
  int cutting = 0, idle = 0;
  bool any_body = false;
  for (Volumes& volumes : volumes_) {
    meshes.push_back(volumes.surface.empty() ? TriangleMesh{} : volumes.surface.take());
    any_body = any_body || !volumes.negative;
    if (volumes.negative) ++(any_body ? cutting : idle);
  }
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (volumes_[i].negative) continue;
    const bool is_cut = std::any_of(volumes_.begin() + static_cast<std::ptrdiff_t>(i), volumes_.end(),
                                    [](const Volumes& volumes) { return volumes.negative; });
    add_mesh(is_cut ? cut(i, meshes, notes) : std::move(meshes[i]), surface);
  }
  if (cutting > 0) notes.push_back(counted(cutting, "cut out of the part"));
  if (idle > 0)
    notes.push_back(counted(idle, idle == 1 ? "cuts nothing, as in the slicer: no body comes before it"
                                            : "cut nothing, as in the slicer: no body comes before them"));
}

TriangleMesh ObjectVolumes::cut(std::size_t bodies, const std::vector<TriangleMesh>& meshes,
                                std::vector<std::string>& notes) const {
  TriangleMesh body = meshes[bodies];
  for (std::string& note : turn_shells(body)) notes.push_back(std::move(note));
  std::vector<TriangleMesh> holes;
  for (std::size_t i = bodies + 1; i < volumes_.size(); ++i)
    if (volumes_[i].negative && !meshes[i].triangles.empty()) turn_shells(holes.emplace_back(meshes[i]));
  for (const TriangleMesh& hole : hole_groups(holes))
    if (!body.triangles.empty()) body = cut_out(body, hole);
  return body;
}

}  // namespace fabseq
