// SPDX-License-Identifier: MIT
#include "fabseq/part/part_settings.h"
#include "fabseq/sequence/sequence_settings.h"

namespace fabseq {

namespace {

using Its = SequenceSettings;

void add_heat(Section<Its>& keys) {
  const SequenceSettings defaults;
  keys.only_for("heat")
      .key("scale", &Its::scale, "Scale on which the optimizer moves the diffusivity",
           {.words = "log linear", .option = "-scale"})
      .key("mass", &Its::mass,
           "Mass matrix of the drain; auto: "
           "lumped where the consistent one would leave the range of temperatures",
           {.words = "auto consistent lumped", .option = "-mass"})
      .key("initial", &Its::initial,
           "Initial diffusivity, uniform or from the distance to the plate inside the part",
           {.range = "(0, inf)", .words = "distance"})
      .key("drain", &Its::drain, "Drain, divided by the square of the characteristic length",
           {.range = "(0, inf)", .option = "-drain"})
      .key("characteristic_length", &Its::characteristic_length,
           "Length of the drain; auto: longest edge of the part's bounding box",
           {.range = "(0, inf)", .words = "auto", .unit = "length", .option = "-characteristic_length"})
      .key("bounds", "Least and largest diffusivity in the part",
           {.type = KeyType::bounds,
            .default_value = to_text(Json{defaults.min_diffusivity, defaults.max_diffusivity}),
            .range = "(0, inf)"},
           [](Its& sequence, const Json& value, const KeyPlace&) {
             value[0].get_to(sequence.min_diffusivity);
             value[1].get_to(sequence.max_diffusivity);
           })
      .key("void", &Its::void_diffusivity, "Diffusivity outside the part", {.range = "(0, inf)"})
      .key("filter_radius", &Its::filter_radius, "Radius of the averaging filter on the diffusivity; 0: none",
           {.range = "[0, inf)", .unit = "length", .option = "-filter_radius"});
}

void add_direct(Section<Its>& keys) {
  keys.only_for("direct")
      .key("location", &Its::location,
           "Where the pseudo-time is a design variable; thickness and uniformity of layers need nodes",
           {.words = "elements nodes"})
      .key("start",
           "Where the pseudo-time is 0: elements by their centres or else by their nodes, "
           "or nodes; plate: what touches the build plate or the substrate",
           {.type = KeyType::shape, .default_value = to_text("plate"), .words = "plate"},
           [](Its& sequence, const Json& value, const KeyPlace& place) {
             if (value.is_object()) sequence.start = make_shape(value, place);
           })
      .key("filter_radius", &Its::filter_radius,
           "Radius within which times are smoothed inside the part, before layers are made of them; 0: none",
           {.range = "[0, inf)", .unit = "length"})
      .then([](Its& sequence, const Json&, const KeyPlace&) { sequence.scale = VariableScale::linear; });
}

}  // namespace

Section<SequenceSettings> sequence_keys() {
  Section<Its> keys("sequence", "Fabrication sequence");
  keys.key("type", &Its::type, "Where the pseudo-time of each element comes from",
           {.required = true, .words = "heat direct planar file"});
  add_heat(keys);
  add_direct(keys);
  keys.only_for("planar").key("direction", &Its::direction,
                              "Build direction, of any length; auto: the plate's normal", {.words = "auto"});
  keys.only_for("file")
      .key("file", &Its::file, "HDF5 file with the pseudo-time of each element",
           {.type = KeyType::path, .required = true})
      .key("dataset", &Its::dataset, "Dataset with axes [z][y][x], values in [0, 1]");
  return keys;
}

}  // namespace fabseq
