// SPDX-License-Identifier: MIT
#include "fabseq/keys/section.h"
#include "fabseq/machine/tool_settings.h"

namespace fabseq {

Section<ToolSettings> tool_keys() {
  using Its = ToolSettings;
  return Section<Its>("tool", "Torch and bead, for what is said of a sequence; nothing here changes it")
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
