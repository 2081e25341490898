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
  return Section<Its>("part.voxels", "Part density from an HDF5 file with axes [z][y][x]")
      .key("file", &Its::file, "HDF5 file", {.type = KeyType::path, .required = true})
      .key("dataset", &Its::dataset, "Dataset whose shape is domain.elements reversed, times sampling")
      .key("threshold", &Its::threshold,
           "Densities from here on count as 1, others as 0; none: the grey density as it is",
           {.range = "(0, 1]", .words = "none"});
}

Section<NearMesh> near_keys() {
  using Its = NearMesh;
  return Section<Its>("node_sets.NAME.near",
                      "Nodes near a surface, such as a face that was exported on its own")
      .key("mesh", &Its::file, "Mesh file, placed like the mesh of the part if the part is one",
           {.type = KeyType::path, .required = true})
      .key("distance", &Its::distance, "How far from it", {.range = "[0, inf)", .unit = "length"});
}

}  // namespace

Section<MeshFile> mesh_keys() {
  using Its = MeshFile;
  return Section<Its>("part.mesh", "Part from the surface of a body: STL, OBJ, PLY or 3MF")
      .key("file", &Its::file, "Mesh file", {.type = KeyType::path, .required = true})
      .key("scale", &Its::scale,
           "Factor from the file's unit of length to the config's; a 3MF file, which names its unit, is "
           "converted to domain.unit before",
           {.range = "(0, inf)"})
      .key("rotate", "Turns of the scaled mesh, one after the other, as pairs of axis and degrees",
           {.type = KeyType::turns, .default_value = "[]"},
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
      .key("place", &Its::as_is,
           "plate: moved along the plate's normal until its lowest point lies at 0, on the plate; as_is: not "
           "moved",
           {.words = "plate as_is"})
      .key("fill", &Its::fill,
           "Elements count as 1 from this share inside the mesh on, others as 0; grey: the share is the "
           "density",
           {.range = "(0, 1]", .words = "grey"})
      .key("least_elements", &Its::least_elements,
           "A part with fewer elements across a wall is refused; 0: any is taken", {.range = "[0, 5]"});
}

Section<PartDescription> part_keys() {
  using Its = PartDescription;
  Section<Its> result("part", "The part: one shape or `voxels`, and");
  result
      .section("voxels", [](Its& part) -> VoxelFile& { return alternative<VoxelFile>(part.source); },
               "In place of a shape: density from a file", voxel_keys(), {.source = true})
      .section("mesh", [](Its& part) -> MeshFile& { return alternative<MeshFile>(part.source); },
               "In place of a shape: a body's surface from a file", mesh_keys(),
               {.dimension = 3, .source = true})
      .key("keep", &Its::keep_connected,
           "Pieces without a path of element faces to the plate are refused (all) "
           "or dropped with a warning (connected)",
           {.words = "all connected"})
      .key("sampling", &Its::sampling,
           "An element's density is the mean over so many points along each axis; "
           "voxel files are as many times finer",
           {.range = "[1, 16]"})
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
      .key("within", &Its::within, "Nodes up to so far outside the shape count, too",
           {.range = "[0, inf)", .unit = "length"})
      .key("samples", &Its::samples,
           "Only so many nodes (at least 2), "
           "equally spaced along the longest edge of the set's bounding box; 0: all",
           {.range = "[0, inf)"})
      .key("surface", &Its::surface,
           "Only nodes on the surface: those with fewer elements of part and "
           "substrate around them than an inner node has; samples are taken of these")
      .key("all", &Its::all, "In place of a shape: every node of the part", {.source = true})
      .section("near", [](Its& set) -> NearMesh& { return set.near ? *set.near : set.near.emplace(); },
               "In place of a shape: the neighbourhood of a surface", near_keys(),
               {.dimension = 3, .source = true})
      .then([](Its& set, const Json& value, const KeyPlace& place) {
        if (!set.all && !set.near) set.shape = make_shape(value, place);
      });
}

BuildPlate make_plate(const std::string& face) { return {face[0] - 'x', face[1] == '+'}; }

}  // namespace fabseq
