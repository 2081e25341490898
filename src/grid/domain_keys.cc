// SPDX-License-Identifier: MIT
#include "fabseq/grid/domain_settings.h"
#include "fabseq/keys/section.h"

namespace fabseq {

Section<DomainSettings> domain_keys() {
  using Its = DomainSettings;
  return Section<Its>("domain", "Box and grid; \"up\" is the last axis")
      .key("size", &Its::size, "Edge lengths of the box, which starts at the origin",
           {.required = true, .range = "(0, inf)", .unit = "length", .option = "-size"})
      .key("elements", &Its::elements, "Elements along each axis; two entries: plane stress, three: solid",
           {.required = true, .range = "[1, inf)", .option = "-elements"})
      .key("thickness", &Its::thickness, "Thickness in plane stress",
           {.range = "(0, inf)", .dimension = 2, .unit = "length"});
}

}  // namespace fabseq
