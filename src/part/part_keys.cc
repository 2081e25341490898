// SPDX-License-Identifier: MIT
#include "fabseq/part/part_settings.h"

namespace fabseq {

namespace {

/// The alternative of a variant, made where it holds another one.
template <class Value, class Variant>
Value& alternative(Variant& variant) {
  return std::holds_alternative<Value>(variant) ? std::get<Value>(variant)
                                                : variant.template emplace<Value>();
}

Section<VoxelFile> voxel_keys() {
  using Its = VoxelFile;
  return Section<Its>("part.voxels", "HDF5 file with axes [z][y][x]")
      .key("file", &Its::file, "HDF5 file", {.type = KeyType::path, .required = true})
      .key("dataset", &Its::dataset, "Its shape: domain.elements reversed, times sampling")
      .key("threshold", &Its::threshold, "Densities from here on count as 1, others as 0; none: grey",
           {.range = "(0, 1]", .words = "none"});
}

Section<NearMesh> near_keys() {
  using Its = NearMesh;
  return Section<Its>("node_sets.NAME.near",
                      "Nodes near a surface, such as a face that was exported on its own")
      .key("mesh", &Its::file, "Mesh file, placed like the part's mesh",
           {.type = KeyType::path, .required = true})
      .key("distance", &Its::distance, "How far from it", {.range = "[0, inf)", .unit = "length"});
}

}  // namespace

Section<MeshFile> mesh_keys() {
  using Its = MeshFile;
  return Section<Its>("part.mesh", "Part from the surface of a body: STL, OBJ, PLY or 3MF")
      .key("file", &Its::file, "Mesh file", {.type = KeyType::path, .required = true})
      .key("scale", &Its::scale, "Factor from the file's unit to the config's; for 3MF from domain.unit",
           {.range = "(0, inf)"})
      .key("rotate", "Turns, one after the other", {.type = KeyType::turns, .default_value = "[]"},
           [](Its& mesh, const Json& value, const KeyPlace&) {
             for (const Json& turn : value) {
               Turn& added = mesh.turns.emplace_back();
               if (turn[0].is_string())
                 added.axis[turn[0].get<std::string>()[0] - 'x'] = 1.0;
               else
                 added.axis = turn[0].get<std::array<double, 3>>();
               added.degrees = turn[1].get<double>();
             }
           })
      .key("place", &Its::as_is, "plate: its lowest point is moved onto the plate; as_is: not moved",
           {.words = "plate as_is"})
      .key("fill", &Its::fill,
           "Share inside the mesh from which an element counts; grey: the share is the density",
           {.range = "(0, 1]", .words = "grey"})
      .key("least_elements", &Its::least_elements, "A part with fewer elements across a wall is refused",
           {.range = "[0, 5]"});
}

Section<PartDescription> part_keys() {
  using Its = PartDescription;
  Section<Its> result("part", "The part: one shape or `voxels`, and");
  result
      .section("voxels", [](Its& part) -> VoxelFile& { return alternative<VoxelFile>(part.source); },
               "Density from a file", voxel_keys(), {.source = true})
      .section("mesh", [](Its& part) -> MeshFile& { return alternative<MeshFile>(part.source); },
               "A body's surface from a file", mesh_keys(), {.dimension = 3, .source = true})
      .key("keep", &Its::keep_connected,
           "Pieces without a path of faces to the plate are refused (all) or dropped (connected)",
           {.words = "all connected"})
      .key("sampling", &Its::sampling,
           "Sample points per element and axis; a voxel file has as many voxels there", {.range = "[1, 16]"})
      .then(
          [](Its& part, const Json& value, const KeyPlace& place) {
            if (std::holds_alternative<Shape>(part.source)) part.source = make_shape(value, place);
          },
          [](Its& part, Json& object) {
            if (const auto* shape = std::get_if<Shape>(&part.source)) write_shape(*shape, object);
          });
  for (SectionKeys& section : shape_declarations()) result.declare(std::move(section));
  return result;
}

Section<NodeSetDescription> node_set_keys() {
  using Its = NodeSetDescription;
  return Section<Its>("node_sets.NAME", "A named set of nodes: one shape, and")
      .key("within", &Its::within, "Nodes so far outside the shape count, too",
           {.range = "[0, inf)", .unit = "length"})
      .key("samples", &Its::samples, "So many nodes, equally spaced along the set's longest edge; 0: all",
           {.range = "[0, inf)"})
      .key("surface", &Its::surface, "Only nodes on the surface of part and substrate")
      .key("all", &Its::all, "Every node of the part", {.source = true})
      .section("near", [](Its& set) -> NearMesh& { return set.near ? *set.near : set.near.emplace(); },
               "The neighbourhood of a surface", near_keys(), {.dimension = 3, .source = true})
      .then([](Its& set, const Json& value, const KeyPlace& place) {
        if (!set.all && !set.near) set.shape = make_shape(value, place);
      });
}

BuildPlate make_plate(const std::string& face) { return {face[0] - 'x', face[1] == '+'}; }

}  // namespace fabseq
