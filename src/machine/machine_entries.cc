// SPDX-License-Identifier: MIT
#include "fabseq/machine/machine_entries.h"

#include "fabseq/base/refusal.h"
#include "fabseq/keys/section.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr const char* positive = "(0, inf)";

bool has(const std::vector<std::string>& axes, const char* axis) {
  return std::find(axes.begin(), axes.end(), axis) != axes.end();
}

void read_axes(MachineEntries& machine, const Json& value, const KeyPlace& place) {
  machine.axes = value.get<std::vector<std::string>>();
  for (const char* needed : {"x", "y", "z"})
    if (!has(machine.axes, needed))
      refuse(place.pointer, shown(value), "x, y, z, and others if there are any");
}

void read_torch(MachineEntries& machine, const Json& value, const KeyPlace&) {
  machine.torch = value.get<std::vector<std::array<double, 2>>>();
}

void read_heights(MachineEntries& machine, const Json& value, const KeyPlace& place) {
  machine.bead_heights = value.get<std::array<double, 2>>();
  const auto [least, most] = *machine.bead_heights;
  if (machine.bead_height < least || machine.bead_height > most)
    refuse(place.pointer, shown(value),
           "a range with bead_height, " + shown(machine.bead_height) + ", in it");
}

void read_plate(MachineEntries& machine, const Json& value, const KeyPlace& place) {
  if (value.size() != 2) refuse(place.pointer, shown(value), "two numbers > 0");
  machine.plate = value.get<std::vector<double>>();
}

}  // namespace

bool MachineEntries::tilts() const { return has(axes, "torch_tilt") || has(axes, "table_tilt"); }

Section<MachineEntries> machine_entries() {
  using Its = MachineEntries;
  return Section<Its>("machine", "Entries of a machine file: objects with `value`, `unit` and `source`")
      .key("name", &Its::name, "A label (a text)")
      .key("comment", "More words (a text)", {.type = KeyType::text},
           [](Its&, const Json&, const KeyPlace&) {})
      .key("axes", "What moves: x, y, z, and what tilts and turns the torch, or the table under the part",
           {.type = KeyType::word_list,
            .required = true,
            .words = "x y z torch_tilt torch_turn table_tilt table_turn"},
           read_axes)
      .key("tilt", &Its::tilt,
           "Largest angle between build direction and plate's normal: of the torch if it tilts or the table "
           "does, else of layers below a torch that stands on the plate",
           {.required = true, .range = "(0, 180]", .unit = "degrees"})
      .key("torch", "Radii of the torch over heights above its tip, as tool.profile",
           {.type = KeyType::profile, .unit = "mm"}, read_torch)
      .key("clearance", &Its::clearance, "Distance that the torch keeps", {.range = "[0, inf)", .unit = "mm"})
      .key("bead_height", &Its::bead_height, "Height that a bead adds",
           {.required = true, .range = positive, .unit = "mm"})
      .key("bead_heights", "Least and largest height of a bead that feed and speed can make",
           {.type = KeyType::bounds, .range = positive, .unit = "mm"}, read_heights)
      .key("bead_width", &Its::bead_width, "Width of a bead",
           {.required = true, .range = positive, .unit = "mm"})
      .key("bridge", &Its::bridge, "Span that a bead bridges",
           {.type = KeyType::number, .range = "[0, inf)", .unit = "mm"})
      .key("deposition_rate", &Its::deposition_rate, "Wire deposited per hour of welding",
           {.type = KeyType::number, .range = positive, .unit = "kg/h"})
      .key("travel_speed", &Its::travel_speed, "Speed of the torch while it welds",
           {.type = KeyType::number, .range = positive, .unit = "mm/s"})
      .key("interpass_limit", &Its::interpass_limit, "Highest temperature below the next bead",
           {.type = KeyType::number, .range = "(-273.15, inf)", .unit = "degrees C"})
      .key("plate", "Edge lengths of the build plate",
           {.type = KeyType::list, .range = positive, .unit = "mm"}, read_plate);
}

}  // namespace fabseq
