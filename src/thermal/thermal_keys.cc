// SPDX-License-Identifier: MIT
#include "fabseq/base/refusal.h"
#include "fabseq/keys/section.h"
#include "fabseq/thermal/thermal_settings.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace fabseq {

namespace {

constexpr const char* temperature_range = "(-273.15, inf)";

void read_steps(ThermalSettings& thermal, const Json& value, const KeyPlace& place) {
  const auto is_count = [](const Json& entry) {
    const double number = entry.get<double>();
    return number == std::floor(number);
  };
  if (value.size() != thermal.steps.size() || !std::all_of(value.begin(), value.end(), is_count))
    refuse(place.pointer, shown(value), "two integers in [1, 1000]");
  for (std::size_t i = 0; i < thermal.steps.size(); ++i) thermal.steps[i] = value[i].get<int>();
}

std::string default_steps() {
  const ThermalSettings settings;
  return to_text(std::vector<int>(settings.steps.begin(), settings.steps.end()));
}

/// A key of the block that may be left to the material's.
void require(const char* key, const char* of_material, bool given) {
  if (given) return;
  refuse(pointer_to("/thermal", key), std::string("\"material\" with material.") + of_material + " \"none\"",
         "a number, or the material's");
}

/// The material's curve; a number in the block itself holds at all temperatures.
IntegratedCurve curve_of(const MaterialSettings& material, const std::vector<double>& factors,
                         bool of_material, double ambient) {
  return of_material ? IntegratedCurve(material.temperatures, factors, ambient) : IntegratedCurve();
}

}  // namespace

Section<ThermalSettings> thermal_keys() {
  using Its = ThermalSettings;
  return Section<Its>("thermal", "Heat conduction through the layers")
      .key("conductivity", &Its::conductivity, "Thermal conductivity at all temperatures",
           {.range = "(0, inf)", .words = "material", .unit = "W/(length*K)"})
      .key("heat_capacity", &Its::heat_capacity, "Specific heat capacity at all temperatures",
           {.range = "(0, inf)", .words = "material", .unit = "J/(kg*K)"})
      .key("heat_input", &Its::heat_input, "Arc power times efficiency over deposition rate",
           {.required = true, .range = "[0, inf)", .unit = "J/kg", .option = "-heat_input"})
      .key("vanishing", &Its::vanishing,
           "Temperature at which the inherent strain vanishes; material: its solidification",
           {.range = temperature_range, .words = "material", .unit = "degrees C"})
      .key("film_coefficient", &Its::film_coefficient,
           "Heat that leaves a surface, by convection and radiation",
           {.range = "[0, inf)", .unit = "W/(length^2*K)"})
      .key("ambient", &Its::ambient, "Temperature of the air",
           {.range = temperature_range, .unit = "degrees C"})
      .key("plate", &Its::plate, "Temperature of the held plate, and of a substrate at the start",
           {.range = temperature_range, .unit = "degrees C"})
      .key("reference", &Its::reference, "Temperature at which material.inherent_strain holds",
           {.range = temperature_range, .unit = "degrees C"})
      .key("passes", &Its::given_passes,
           "Real layers per simulated layer, each with its pause; layers: layers.passes",
           {.range = "[1, inf)", .words = "layers", .unit = "layers"})
      .key("interpass_limit", &Its::interpass_limit,
           "Interpass temperature for which a run reports the pauses",
           {.range = temperature_range, .words = "none", .unit = "degrees C"})
      .key("steps", "Time steps of each layer, while welding and in the last pause",
           {.type = KeyType::list, .default_value = default_steps(), .range = "[1, 1000]", .unit = "steps"},
           read_steps);
}

void check_thermal(const ThermalSettings& thermal, const MaterialSettings& material,
                   const ProcessSettings& process) {
  if (!material.mass_density)
    refuse("/material/mass_density", "\"none\" with a block thermal", "a number > 0");
  if (!process.deposition_rate)
    refuse("/process/deposition_rate", "\"none\" with a block thermal", "a number > 0");
  require("conductivity", "conductivity", thermal.conductivity || material.conductivity);
  require("heat_capacity", "heat_capacity", thermal.heat_capacity || material.heat_capacity);
  require("vanishing", "solidification", thermal.vanishing || material.solidification);
  const ThermalProperties properties(thermal, material, process);
  if (properties.vanishing <= properties.reference)
    refuse("/thermal/vanishing", shown(properties.vanishing),
           "more than thermal.reference, " + shown(properties.reference));
  if (thermal.interpass_limit && *thermal.interpass_limit <= thermal.ambient)
    refuse("/thermal/interpass_limit", shown(*thermal.interpass_limit),
           "more than thermal.ambient, " + shown(thermal.ambient));
}

ThermalProperties::ThermalProperties(const ThermalSettings& thermal, const MaterialSettings& material,
                                     const ProcessSettings& process)
    : conductivity(thermal.conductivity ? *thermal.conductivity : material.conductivity.value()),
      conduction(curve_of(material, material.conductivity_factors, !thermal.conductivity, thermal.ambient)),
      storage(curve_of(material, material.heat_capacity_factors, !thermal.heat_capacity, thermal.ambient)),
      capacity(*material.mass_density *
               (thermal.heat_capacity ? *thermal.heat_capacity : material.heat_capacity.value())),
      heat(thermal.heat_input * *material.mass_density),
      mass_density(*material.mass_density),
      rate(*process.deposition_rate / seconds_per_hour),
      pause(process.dwell),
      film(thermal.film_coefficient),
      ambient(thermal.ambient),
      plate(thermal.plate),
      reference(thermal.reference),
      vanishing(thermal.vanishing ? *thermal.vanishing : material.solidification.value()),
      passes(thermal.passes),
      welding_steps(thermal.steps[0]),
      pause_steps(thermal.steps[1]) {}

double ThermalProperties::strain_share(double interpass) const {
  return std::max(0.0, 1.0 - (interpass - reference) / (vanishing - reference));
}

double ThermalProperties::strain_share_slope(double interpass) const {
  return strain_share(interpass) > 0.0 ? -1.0 / (vanishing - reference) : 0.0;
}

}  // namespace fabseq
