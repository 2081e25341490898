// SPDX-License-Identifier: MIT
#include "fabseq/config/unlikely_numbers.h"

#include "fabseq/base/formatted.h"
#include "fabseq/mesh/length_units.h"
#include "fabseq/process/inherent_strain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace fabseq {

namespace {

/// Values between these ends are ordinary. Wide, so that what lies outside is in another unit.
struct Usual {
  double least, most;

  bool has(double value) const { return value >= least && value <= most; }
};

constexpr double most_strain = 0.1;
constexpr double hottest_surroundings = 150.0;  // degrees C, of air, plate and reference
constexpr double hottest_solid = 3500.0;        // degrees C: tungsten melts at 3420
constexpr double most_fourier = 1000.0;
constexpr double most_melting_heats = 100.0;    // of an arc: 2 to 20
constexpr Usual yield_strains{1e-5, 0.1};       // metals: 0.0005 to 0.02
constexpr Usual densities{100.0, 30000.0};      // kg/m^3; aluminium 2700, tungsten 19300
constexpr Usual capacities{50.0, 10000.0};      // J/(kg K); gold 130, aluminium 900
constexpr Usual conductivities{0.1, 5000.0};    // W/(m K); titanium 7, copper 400
constexpr Usual heat_factors{0.1, 15.0};        // of a solid: 0.5 to 12, where iron transforms
constexpr Usual biot_numbers{1e-7, 50.0};       // of an element; arc welding: 1e-5 to 0.1
constexpr Usual rates{0.005, 200.0};            // kg/h; arc welding: 0.3 to 20
constexpr Usual speed_ratios{0.5, 2.0};         // density, bead's section, speed over rate
constexpr Usual build_hours{1e-6, 2e4};         // two years
constexpr double longest_pause = 86400.0;       // s
constexpr Usual profile_reaches{0.02, 1000.0};  // of a torch over the part's longest edge

/// Collects the lines.
class UnlikelyNumbers {
 public:
  UnlikelyNumbers(const ModelSettings& settings, const PartFigures& part)
      : settings_(settings), part_(part), metres_(metres_in(settings.unit)) {}

  std::vector<std::string> lines() {
    check_strain();
    check_yield();
    const bool dense = check_density();
    check_deposition(dense);
    if (dense) check_speed();
    check_lengths();
    check_angles();
    if (settings_.thermal) check_heat(*settings_.thermal);
    return std::move(lines_);
  }

 private:
  void say(const std::string& key, const std::string& found, const std::string& expected) {
    lines_.push_back(key + ": found " + found + "; expected: " + expected);
  }

  void check_strain() {
    const MaterialSettings& material = settings_.material;
    double largest = largest_strain(material);
    if (material.turning_strain && !material.strain_scale.empty())
      largest *= std::ranges::max(material.strain_scale);
    const char* const expected = "at most 0.1; a strain of 1 % is 0.01";
    if (largest == 0.0)
      say("/material/inherent_strain", "0, with which nothing shrinks",
          "what the material shrinks by, such as -0.01");
    if (largest > most_strain) {
      say("/material/inherent_strain", formatted("%g in magnitude, with strain_scale", largest), expected);
      return;
    }
    double factor = 1.0;
    for (const std::vector<double>& scenario : material.scenarios)
      for (const double entry : scenario) factor = std::max(factor, entry);
    if (factor * largest > most_strain)
      say("/material/scenarios",
          formatted("a factor of %g, with which a strain is %g", factor, factor * largest), expected);
  }

  /// Young's modulus is 1 where the config does not say it.
  void check_yield() {
    const MaterialSettings& material = settings_.material;
    if (!material.yield_stress) return;
    const double strain = *material.yield_stress / material.young;
    if (yield_strains.has(strain)) return;
    say("/material/yield_stress",
        formatted("%g with young %g, which is %.2g of it", *material.yield_stress, material.young, strain),
        "both in one unit of stress; 0.0005 to 0.02 of Young's modulus");
  }

  /// A length's power of ten is what tells kg/mm^3 from kg/m^3. Returns whether the density may be right.
  bool check_density() {
    const auto& density = settings_.material.mass_density;
    if (!density || !metres_) return true;
    const double in_metres = *density / std::pow(*metres_, 3);
    if (densities.has(in_metres)) return true;
    say("/material/mass_density",
        formatted("%g, which with lengths in %s is %.3g kg/m^3", *density, settings_.unit.c_str(), in_metres),
        formatted("kg/length^3; steel: %.3g", 7850.0 * std::pow(*metres_, 3)));
    return false;
  }

  void check_deposition(bool dense) {
    const ProcessSettings& process = settings_.process;
    if (process.dwell > longest_pause)
      say("/process/dwell", formatted("%g, which is %.3g days", process.dwell, process.dwell / 86400.0),
          "seconds, at most a day");
    if (!process.deposition_rate) return;
    if (!rates.has(*process.deposition_rate)) {
      say("/process/deposition_rate", formatted("%g", *process.deposition_rate),
          "kg/h; arc welding: 0.3 to 20");
      return;
    }
    const auto& density = settings_.material.mass_density;
    if (!density || !dense) return;
    const double hours = *density * part_.volume / *process.deposition_rate;
    if (!build_hours.has(hours))
      say("/material/mass_density", formatted("%g, with which welding takes %.3g hours", *density, hours),
          "kg/length^3, such as 7.85e-6 for steel with lengths in mm");
  }

  /// A bead's section times the speed is what the torch deposits.
  void check_speed() {
    const ToolSettings& tool = settings_.tool;
    const auto& rate = settings_.process.deposition_rate;
    const auto& density = settings_.material.mass_density;
    if (!tool.travel_speed || !tool.bead_height || tool.bead_width == 0.0 || !rate || !density) return;
    constexpr double seconds_in_hour = 3600.0;
    const double made = *density * tool.bead_width * *tool.bead_height * *tool.travel_speed * seconds_in_hour;
    if (speed_ratios.has(made / *rate)) return;
    say("/tool/travel_speed",
        formatted("%g, with which a bead of this width and height takes %.3g kg/h", *tool.travel_speed, made),
        formatted("about process.deposition_rate, %g", *rate));
  }

  void check_lengths() {
    const ToolSettings& tool = settings_.tool;
    if (tool.bead_width > part_.longest_edge ||
        (tool.bead_width > 0.0 && tool.bead_width < 0.5 * part_.smallest_spacing))
      say("/tool/bead_width", formatted("%g", tool.bead_width),
          formatted("half an element, %g, to the part's longest edge, %g", 0.5 * part_.smallest_spacing,
                    part_.longest_edge));
    if (const auto& target = settings_.layers.target) check_layer(target->key, target->bead);
    if (const auto& slices = settings_.layers.multi_planar)
      check_layer("/layers/thickness", slices->thickness);
    double reach = 0.0;
    for (const auto& [height, radius] : tool.profile) reach = std::max({reach, std::abs(height), radius});
    if (!tool.profile.empty() && !profile_reaches.has(reach / part_.longest_edge))
      say("/tool/profile", formatted("a torch that reaches %g", reach),
          formatted("lengths in the unit of the part, whose longest edge is %g", part_.longest_edge));
  }

  /// Checks the thickness of a real layer, and of those that a simulated one stands for.
  void check_layer(const std::string& key, double thickness) {
    const int passes = settings_.layers.passes;
    const std::string expected = formatted("at most the part's longest edge, %g", part_.longest_edge);
    if (thickness > part_.longest_edge)
      say(key, formatted("%g", thickness), expected);
    else if (passes * thickness > part_.longest_edge)
      say("/layers/passes", formatted("%d, with which a layer is %g thick", passes, passes * thickness),
          expected);
  }

  /// 90 degrees are 1.57 radians, and a whole turn is 6.28 of them.
  void check_angles() {
    constexpr double right_angle = 0.5 * std::numbers::pi;
    if (settings_.tool.max_tilt <= right_angle + 1e-3)
      say("/tool/max_tilt", formatted("%g", settings_.tool.max_tilt), "degrees, more than 1.57");
    const auto& slices = settings_.layers.multi_planar;
    if (!slices) return;
    double largest = 0.0;
    for (const auto* angles : {&slices->angles, &slices->lowest_angles, &slices->highest_angles})
      for (const double angle : *angles) largest = std::max(largest, std::abs(angle));
    if (largest > 4.0 * right_angle + 1e-3)
      say("/layers/angles", formatted("%g, in angles or angle_bounds", largest), "radians, at most 6.28");
  }

  void check_temperatures(const ThermalSettings& thermal, double vanishing) {
    const std::pair<const char*, double> surroundings[] = {
        {"ambient", thermal.ambient}, {"plate", thermal.plate}, {"reference", thermal.reference}};
    for (const auto& [key, value] : surroundings)
      if (value > hottest_surroundings)
        say(std::string("/thermal/") + key, formatted("%g", value), "degrees C, at most 150; 293 K are 20");
    if (vanishing > hottest_solid)
      say("/thermal/vanishing", formatted("%g", vanishing), "degrees C, at most 3500");
    if (thermal.interpass_limit && *thermal.interpass_limit >= vanishing)
      say("/thermal/interpass_limit", formatted("%g", *thermal.interpass_limit),
          formatted("degrees C, below thermal.vanishing, %g", vanishing));
  }

  /// Checks wire and arc: the heat melts the wire, and is less than what evaporates it many times.
  void check_heat_input(const ThermalSettings& thermal, double capacity,
                        const ThermalProperties& properties) {
    if (!capacities.has(capacity) || properties.vanishing > hottest_solid) return;  // said elsewhere
    const double needed = capacity * (properties.vanishing - properties.ambient);
    if (thermal.heat_input >= needed && thermal.heat_input <= most_melting_heats * needed) return;
    say("/thermal/heat_input", formatted("%g", thermal.heat_input),
        formatted("J/kg, power of the arc over kg/s of wire: more than the %.2g that heat it from ambient to "
                  "vanishing, and not 100 times as much",
                  needed));
  }

  /// A known unit of length tells whether k is that of a solid; without one, how far heat gets does.
  void check_conduction(const ThermalSettings& thermal, double capacity,
                        const ThermalProperties& properties) {
    if (!capacities.has(capacity))
      return say(thermal.heat_capacity ? "/thermal/heat_capacity" : "/material/heat_capacity",
                 formatted("%g", capacity), "J/(kg K), such as 600 for steel");
    const std::string key = thermal.conductivity ? "/thermal/conductivity" : "/material/conductivity";
    if (!metres_) return check_fourier(key, properties);
    const double in_metres = properties.conductivity / *metres_;
    if (!conductivities.has(in_metres))
      say(key,
          formatted("%g, which with lengths in %s is %.3g W/(m K)", properties.conductivity,
                    settings_.unit.c_str(), in_metres),
          formatted("W/(length K); steel: %.3g", 40.0 * *metres_));
  }

  /// Factors that are conductivities or heat capacities themselves.
  void check_factors(const char* key, const std::vector<double>& factors, const char* of) {
    for (const double factor : factors)
      if (!heat_factors.has(factor))
        return say(key, formatted("%g", factor), formatted("factors on material.%s, between 0.1 and 15", of));
  }

  /// Heat that gets through thirty elements in one step, as no step is meant to.
  void check_fourier(const std::string& key, const ThermalProperties& properties) {
    const double welding = properties.mass_density * part_.volume / (part_.layers * properties.rate) +
                           (properties.passes - 1) * properties.pause;
    const double step =
        std::max(welding / properties.welding_steps, properties.pause / properties.pause_steps);
    const double fourier =
        properties.diffusivity() * step / (part_.smallest_spacing * part_.smallest_spacing);
    if (fourier <= most_fourier) return;
    say(key,
        formatted("%g, a Fourier number of %.3g in a step of %.3g s", properties.conductivity, fourier, step),
        "at most 1000 in an element; W/(length K), such as 0.04 for steel with lengths in mm");
  }

  void check_heat(const ThermalSettings& thermal) {
    const ThermalProperties properties(thermal, settings_.material, settings_.process);
    const double capacity = properties.capacity / properties.mass_density;
    check_temperatures(thermal, properties.vanishing);
    check_heat_input(thermal, capacity, properties);
    check_conduction(thermal, capacity, properties);
    const MaterialSettings& material = settings_.material;
    check_factors("/material/conductivity_factors", material.conductivity_factors, "conductivity");
    check_factors("/material/heat_capacity_factors", material.heat_capacity_factors, "heat_capacity");
    const double biot = thermal.film_coefficient * part_.smallest_spacing / properties.conductivity;
    if (thermal.film_coefficient > 0.0 && !biot_numbers.has(biot))
      say("/thermal/film_coefficient",
          formatted("%g, a Biot number of %.2g in an element", thermal.film_coefficient, biot),
          "W/(length^2 K), such as 2e-5 with lengths in mm");
  }

  const ModelSettings& settings_;
  const PartFigures& part_;
  std::optional<double> metres_;  ///< in the unit of length; none: it has no known name
  std::vector<std::string> lines_;
};

}  // namespace

std::vector<std::string> unlikely_numbers(const ModelSettings& settings, const PartFigures& part) {
  return UnlikelyNumbers(settings, part).lines();
}

}  // namespace fabseq
