// SPDX-License-Identifier: MIT
#include "fabseq/keys/section.h"
#include "fabseq/machine/tool_settings.h"

namespace fabseq {

Section<ToolSettings> tool_keys() {
  using Its = ToolSettings;
  return Section<Its>("tool", "Torch and bead, for what is said of a sequence and for constraints on it")
      .key("profile",
           "The torch as a body of revolution: pairs of a height above its tip and the radius there, linear "
           "between them; there is nothing below the first and above the last. Empty: no torch is checked",
           {.type = KeyType::profile, .default_value = "[]", .unit = "length"},
           [](Its& tool, const Json& value, const KeyPlace&) {
             tool.profile = value.get<std::vector<std::array<double, 2>>>();
           })
      .key("axis", &Its::axis,
           "Axis of the torch, from its tip upwards: the build direction of each element, or a vector of any "
           "length for a machine that does not tilt it",
           {.words = "normal"})
      .key("clearance", &Its::clearance, "Distance that the torch keeps from what is there",
           {.range = "[0, inf)", .unit = "length"})
      .key("max_tilt", &Its::max_tilt, "Largest angle between the torch's axis and the plate's normal",
           {.range = "(0, 180]", .unit = "degrees", .option = "-max_tilt"})
      .key("bead_width", &Its::bead_width,
           "Width of a weld bead: an element hangs in the air if nothing lies below it within half of it; "
           "0: two elements' longest edges",
           {.range = "[0, inf)", .unit = "length", .option = "-bead_width"})
      .key("thickness",
           "Least and largest local thickness of a layer that can be deposited, relative to the target",
           {.type = KeyType::bounds, .default_value = "[0.5, 1.5]", .range = "(0, inf)"},
           [](Its& tool, const Json& value, const KeyPlace&) {
             tool.thickness = {value[0].get<double>(), value[1].get<double>()};
           });
}

}  // namespace fabseq
