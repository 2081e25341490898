// SPDX-License-Identifier: MIT
#include "fabseq/part/part_settings.h"

namespace fabseq {

namespace {

Section<VoxelFile> voxel_keys() {
  using Its = VoxelFile;
  return Section<Its>("part.voxels", "Part density from an HDF5 file with axes [z][y][x]")
      .key("file", &Its::file, "HDF5 file", {.type = KeyType::path, .required = true})
      .key("dataset", &Its::dataset, "Dataset whose shape is domain.elements reversed, times sampling")
      .key("threshold", &Its::threshold,
           "Densities from here on count as 1, others as 0; none: the grey density as it is",
           {.range = "(0, 1]", .words = "none"});
}

}  // namespace

Section<PartDescription> part_keys() {
  using Its = PartDescription;
  Section<Its> result("part", "The part: one shape or `voxels`, and");
  result
      .section("voxels", [](Its& part) -> VoxelFile& { return part.source.emplace<VoxelFile>(); },
               "In place of a shape: density from a file", voxel_keys(), {.source = true})
      .key("stl", "In place of a shape: surface from a file", {.type = KeyType::unavailable}, {})
      .key("keep", &Its::keep_connected,
           "Pieces without a path of element faces to the plate are refused (all) "
           "or dropped with a warning (connected)",
           {.words = "all connected"})
      .key("sampling", &Its::sampling,
           "An element's density is the mean over so many points along each axis; "
           "voxel files are as many times finer",
           {.range = "[1, 16]"})
      .then([](Its& part, const Json& value, const KeyPlace& place) {
        if (find_member(value, "voxels") == nullptr) part.source = make_shape(value, place);
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
      .then([](Its& set, const Json& value, const KeyPlace& place) {
        if (!set.all) set.shape = make_shape(value, place);
      });
}

BuildPlate make_plate(const std::string& face) { return {face[0] - 'x', face[1] == '+'}; }

}  // namespace fabseq
