// SPDX-License-Identifier: MIT
#include "fabseq/grid/domain_settings.h"
#include "fabseq/keys/section.h"

namespace fabseq {

namespace {

/// Keys from which a mesh's box follows are gone once it has been placed.
void refuse_without_mesh(DomainSettings& /*settings*/, const Json& value, const KeyPlace& place) {
  refuse(place.pointer, shown(value), "this key with part.mesh and without domain.size and domain.elements");
}

}  // namespace

Section<DomainSettings> domain_keys() {
  using Its = DomainSettings;
  return Section<Its>("domain", "Box and grid; \"up\" is the last axis")
      .key("size", &Its::size, "Edge lengths of the box (not with element)",
           {.required = true, .range = "(0, inf)", .unit = "length", .option = "-size"})
      .key("origin", &Its::origin, "Lower corner of the box; left out: 0", {.unit = "length"})
      .key("elements", &Its::elements, "Elements along each axis (not with element); two: plane stress",
           {.required = true, .range = "[1, inf)", .option = "-elements"})
      .key("element",
           "With part.mesh, instead of size, origin and elements: edge length of an element, or one per axis",
           {.type = KeyType::lengths, .range = "(0, inf)", .unit = "length", .option = "-element"},
           refuse_without_mesh)
      .key("margin",
           "With element: room around the mesh on all sides but the plate's, or per axis; left out: 0",
           {.type = KeyType::lengths, .range = "[0, inf)", .unit = "length"}, refuse_without_mesh)
      .key("thickness", &Its::thickness, "Thickness in plane stress",
           {.range = "(0, inf)", .dimension = 2, .unit = "length"})
      .key("unit", &Its::unit,
           "Length unit: a label, and the unit to which 3MF files are converted, if it is um, mm, cm, m, in, "
           "ft or a name of these",
           {});
}

}  // namespace fabseq
