// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "mesh/mesh_formats.h"
#include "mesh/object_volumes.h"
#include "mesh/three_mf_model.h"
#include "mesh/three_mf_package.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace fabseq {

namespace {

/// First `inner`, then `outer`.
Placement product(const Placement& outer, const Placement& inner) {
  Placement result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      result[row][column] = column == 3 ? outer[row][3] : 0.0;
      for (int k = 0; k < 3; ++k) result[row][column] += outer[row][k] * inner[k][column];
    }
  return result;
}

bool mirrors(const Placement& p) {
  return p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
             p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
             p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]) <
         0.0;
}

/// A mesh of an object where it stands; one that is mirrored still faces outward.
ThreeMfModel::Object placed(const ThreeMfModel::Object& object, const Placement& placement) {
  ThreeMfModel::Object result{object.vertices, object.triangles, {}};
  for (Point<3>& point : result.vertices) {
    const Point<3> old = point;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = placement[axis][3];
      for (int k = 0; k < 3; ++k) point[axis] += placement[axis][k] * old[k];
    }
  }
  if (mirrors(placement))
    for (auto& triangle : result.triangles) std::swap(triangle[1], triangle[2]);
  return result;
}

/// What objects are left out, and how many of each sort.
class LeftOut {
 public:
  /// `one` and `several`: in words.
  void add(const std::string& one, const std::string& several, std::int64_t count = 1) {
    found_[one].first += count;
    found_[one].second = several;
  }
  /// One for each sort.
  std::vector<std::string> groups() const {
    std::vector<std::string> result;
    for (const auto& [one, found] : found_)
      result.push_back(std::to_string(found.first) + " " + (found.first == 1 ? one : found.second));
    return result;
  }

 private:
  std::map<std::string, std::pair<std::int64_t, std::string>> found_;
};

/// Follows the items of a build to their meshes.
class PartOfBuild {
 public:
  PartOfBuild(const ThreeMfPackage& package, const ThreeMfModel& model, ThreeMfObjects wanted,
              std::vector<std::string>& notes)
      : package_(package), model_(model), wanted_(wanted), notes_(notes) {}

  TriangleMesh mesh() {
    for (std::size_t i = 0; i < model_.items.size(); ++i) {
      const ThreeMfContents::Item item =
          i < package_.contents.items.size() ? package_.contents.items[i] : ThreeMfContents::Item{};
      if (item.printable)
        add_whole(model_.items[i], item.object);
      else
        left_out_.add("object not to be printed", "objects not to be printed");
    }
    if (package_.contents.lattices > 0)
      left_out_.add("beam lattice, which is not read,", "beam lattices, which are not read,",
                    package_.contents.lattices);
    const std::vector<std::string> groups = left_out_.groups();
    if (surface_.empty() && !groups.empty()) {
      std::string all;
      for (const std::string& group : groups) all += (all.empty() ? "" : ", ") + group;
      throw InputError("has nothing but " + all + "; needs a body that is to be built");
    }
    for (const std::string& group : groups) notes_.push_back(group + " left out of the part");
    return surface_.take();
  }

 private:
  using Instance = ThreeMfModel::Instance;

  /// What a slicer says of an object; null: nothing.
  template <class Of>
  const Of* said_of(const std::map<std::string, Of>& volumes, const ThreeMfName& name) const {
    const auto found = name.file == package_.root ? volumes.find(name.number) : volumes.end();
    return found != volumes.end() ? &found->second : nullptr;
  }
  bool is_slicers_object(const ThreeMfName& name) const {
    return said_of(package_.volumes.ranges, name) != nullptr ||
           said_of(package_.volumes.parts, name) != nullptr;
  }

  /// Adds an object that cuts nothing else and is cut by nothing else.
  void add_whole(const Instance& instance, const ThreeMfName& name) {
    ObjectVolumes volumes;
    add(instance, name, {}, volumes);
    volumes.build(surface_, notes_);
  }

  void add(const Instance& instance, const ThreeMfName& name, const VolumeUse& use, ObjectVolumes& volumes) {
    const auto facts = package_.contents.objects.find(name);
    const std::string type = facts != package_.contents.objects.end() ? facts->second.type : "model";
    if (type != "model" && !(type == "surface" && wanted_ == ThreeMfObjects::surfaces_too))
      return left_out_.add("object of type \"" + type + '"', "objects of type \"" + type + '"');
    const ThreeMfModel::Object& object = model_.objects[instance.object];
    if (use.kind == VolumeUse::helper) return left_out_.add(use.name, use.several);
    if (!object.triangles.empty()) add_mesh(placed(object, instance.placement), name, use, volumes);
    std::map<std::string, std::size_t> met;
    for (std::size_t i = 0; i < object.components.size(); ++i) {
      const Instance& inner = object.components[i];
      const Instance component{inner.object, product(instance.placement, inner.placement)};
      const bool named = facts != package_.contents.objects.end() && i < facts->second.components.size();
      const ThreeMfName inner_name = named ? facts->second.components[i] : ThreeMfName{};
      const VolumeUse inner_use = use_of_component(name, inner_name.number, met[inner_name.number]++, use);
      if (inner_use.kind == VolumeUse::body && is_slicers_object(inner_name))
        add_whole(component, inner_name);
      else
        add(component, inner_name, inner_use, volumes);
    }
  }

  /// What the component with this number is for, of which there were so many before in the object.
  VolumeUse use_of_component(const ThreeMfName& object, const std::string& number, std::size_t before,
                             const VolumeUse& otherwise) const {
    const std::vector<SlicerVolumes::Part>* parts = said_of(package_.volumes.parts, object);
    if (parts == nullptr) return otherwise;
    VolumeUse result = otherwise;
    for (const SlicerVolumes::Part& part : *parts) {
      if (part.object != number) continue;
      result = part.use;
      if (before-- == 0) break;
    }
    return result;
  }

  void add_mesh(const ThreeMfModel::Object& mesh, const ThreeMfName& name, const VolumeUse& use,
                ObjectVolumes& volumes) {
    const std::vector<SlicerVolumes::Range>* ranges = said_of(package_.volumes.ranges, name);
    const auto count = static_cast<std::int64_t>(mesh.triangles.size());
    if (ranges == nullptr || ranges->empty())
      return add_volume(mesh, 0, count, use_of_component(name, name.number, 0, use), volumes);
    std::int64_t covered = 0;
    for (const SlicerVolumes::Range& range : *ranges) {
      const std::int64_t first = range.first, end = range.last + 1;
      if (end <= first || end > count)
        throw InputError("has a volume of the triangles " + std::to_string(range.first) + " to " +
                         std::to_string(range.last) + " in object " + name.number + ", which has " +
                         std::to_string(count) + ", needs an intact 3MF file");
      covered += end - first;
      add_volume(mesh, first, end, range.use, volumes);
    }
    if (covered < count) left_out_.add("triangle of no volume", "triangles of no volume", count - covered);
  }

  void add_volume(const ThreeMfModel::Object& mesh, std::int64_t first, std::int64_t end,
                  const VolumeUse& use, ObjectVolumes& volumes) {
    if (use.kind == VolumeUse::helper) return left_out_.add(use.name, use.several);
    volumes.add(use.kind == VolumeUse::negative, mesh.vertices,
                std::span(mesh.triangles).subspan(first, end - first));
  }

  const ThreeMfPackage& package_;
  const ThreeMfModel& model_;
  ThreeMfObjects wanted_;
  std::vector<std::string>& notes_;
  SurfaceBuilder surface_;
  LeftOut left_out_;
};

}  // namespace

TriangleMesh read_three_mf(std::string file, ThreeMfObjects wanted, std::vector<std::string>& notes,
                           std::string& unit) {
  ThreeMfPackage package = prepare_three_mf(std::move(file));
  const ThreeMfModel model = read_three_mf_model(package.bytes);
  unit = model.unit;
  return PartOfBuild(package, model, wanted, notes).mesh();
}

}  // namespace fabseq
