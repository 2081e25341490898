// SPDX-License-Identifier: MIT
#include "fabseq/base/refusal.h"
#include "fabseq/keys/section.h"
#include "fabseq/machine/tool_settings.h"

namespace fabseq {

namespace {

void read_plate(ToolSettings& tool, const Json& value, const KeyPlace& place) {
  if (!value.empty() && value.size() != 2) refuse(place.pointer, shown(value), "two numbers > 0, or []");
  tool.plate = value.get<std::vector<double>>();
}

}  // namespace

Section<ToolSettings> tool_keys() {
  using Its = ToolSettings;
  return Section<Its>("tool", "Torch and bead, for checks and constraints")
      .key("name", &Its::name, "A label of the machine")
      .key("profile", "The torch: radii over heights above its tip, linear between them; empty: not checked",
           {.type = KeyType::profile, .default_value = "[]", .unit = "length"},
           [](Its& tool, const Json& value, const KeyPlace&) {
             tool.profile = value.get<std::vector<std::array<double, 2>>>();
           })
      .key("axis", &Its::axis,
           "Axis of the torch: the build direction, or a vector for a machine that does not tilt it",
           {.words = "normal"})
      .key("clearance", &Its::clearance, "Distance that the torch keeps",
           {.range = "[0, inf)", .unit = "length"})
      .key("max_tilt", &Its::max_tilt, "Largest angle between torch and plate's normal",
           {.range = "(0, 180]", .unit = "degrees", .option = "-max_tilt"})
      .key("bead_width", &Its::bead_width, "Width of a weld bead; 0: twice the longest edge",
           {.range = "[0, inf)", .unit = "length", .option = "-bead_width"})
      .key("bead_height", &Its::bead_height, "Height that a weld bead adds; a layer may stand for several",
           {.range = "(0, inf)", .words = "none", .unit = "length"})
      .key("thickness", "Least and largest local thickness that can be deposited, over the target",
           {.type = KeyType::bounds, .default_value = "[0.5, 1.5]", .range = "(0, inf)"},
           [](Its& tool, const Json& value, const KeyPlace&) {
             tool.thickness = {value[0].get<double>(), value[1].get<double>()};
           })
      .key("bridge", &Its::bridge, "Span that a bead bridges, for -task check; auto: two widths of a bead",
           {.range = "[0, inf)", .words = "auto", .unit = "length"})
      .key("travel_speed", &Its::travel_speed, "Speed of the torch while it welds",
           {.range = "(0, inf)", .words = "none", .unit = "length/s"})
      .key("plate", "Edge lengths of the build plate, on which the part must fit; empty: not checked",
           {.type = KeyType::list, .default_value = "[]", .range = "(0, inf)", .unit = "length"}, read_plate)
      .key("most_places", &Its::most_places,
           "Most places smaller than a bead with which a sequence still is buildable but for them; 0: none",
           {.range = "[0, 50]"})
      .key("places_share", &Its::places_share, "Largest share of the part that begins on such places",
           {.range = "[0, 1]"});
}

}  // namespace fabseq
