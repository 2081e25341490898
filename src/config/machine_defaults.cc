// SPDX-License-Identifier: MIT
#include "config/machine_defaults.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/refusal.h"
#include "fabseq/mesh/length_units.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace fabseq {

namespace {

constexpr double metres_in_mm = 1e-3;
constexpr double all_directions = 180.0;  // degrees: no limit

/// A number without the digits that conversion has added.
double plain(double value) { return number_in<double>(formatted("%.10g", value)).value(); }

/// Writes what a machine means for one config.
class MachineDefaults {
 public:
  MachineDefaults(const MachineEntries& machine, Json& document)
      : machine_(machine), document_(document), unit_(unit_of(document)) {}

  void add() {
    add_layers();
    add_tool();
    const auto put_if_known = [&](const char* section, const char* key, const std::optional<double>& value) {
      if (value) put(section, key, *value);
    };
    put_if_known("process", "deposition_rate", machine_.deposition_rate);
    if (!is_object("thermal")) return;
    if (!has_passes()) put("thermal", "passes", beads());
    put_if_known("thermal", "interpass_limit", machine_.interpass_limit);
  }

 private:
  /// Units of length of the config in a millimetre.
  static double unit_of(const Json& document) {
    const Json* unit = find_member(document, "domain", "unit");
    const auto metres =
        unit != nullptr && unit->is_string() ? metres_in(unit->get<std::string>()) : std::nullopt;
    if (!metres)
      refuse("/domain/unit",
             (unit == nullptr ? "none" : shown(*unit)) + " with a machine, whose lengths are in mm",
             "um, mm, cm, m, in or ft");
    return metres_in_mm / *metres;
  }

  double length(double millimetres) const { return plain(unit_ * millimetres); }

  bool is_object(const char* section) const {
    const Json* found = find_member(document_, section);
    return found != nullptr && found->is_object();
  }

  /// Sets a key that the config lacks.
  void put(const char* section, const char* key, const Json& value) {
    Json& object = document_[section];
    if (!object.is_null() && !object.is_object()) return;
    if (!object.contains(key)) object[key] = value;
  }

  bool has_sub_parts() const {
    const Json* type = find_member(document_, "layers", "type");
    return type != nullptr && *type == "multi_planar";
  }

  /// Thickness of the config's layers, and the key that says it; none: it says nothing.
  std::optional<std::pair<double, std::string>> thickness() const {
    const char* key = has_sub_parts() ? "thickness" : "target";
    if (const Json* given = find_member(document_, "layers", key); given != nullptr && given->is_number())
      return std::pair{given->get<double>(), std::string("/layers/") + key};
    const Json* constraints = find_member(document_, "constraints");
    for (std::size_t i = 0; constraints != nullptr && constraints->is_array() && i < constraints->size();
         ++i) {
      const Json *type = find_member((*constraints)[i], "type"),
                 *target = find_member((*constraints)[i], "target");
      if (type != nullptr && *type == "layer_thickness" && target != nullptr && target->is_number())
        return std::pair{target->get<double>(), "/constraints/" + std::to_string(i) + "/target"};
    }
    return std::nullopt;
  }

  /// Whether the config says how many real layers a simulated one stands for: lengths are of real ones then.
  bool has_passes() const { return find_member(document_, "layers", "passes") != nullptr; }

  /// How many beads such a length stands for: what the config says, or else as fits best.
  int beads() const {
    if (has_passes()) return 1;
    const Json* given = find_member(document_, "thermal", "passes");
    if (given != nullptr && given->is_number_integer() && *given >= 1) return given->get<int>();
    constexpr double most = 1e6;
    const auto found = thickness();
    const double count = found ? found->first / (unit_ * machine_.bead_height) : 1.0;
    return static_cast<int>(std::lround(std::clamp(count, 1.0, most)));
  }

  void add_layers() {
    const double usual = length(beads() * machine_.bead_height);
    const auto found = thickness();
    const double target = found ? found->first : usual;
    if (has_sub_parts())
      put("layers", "thickness", target);
    else if (!found)
      put("layers", "target", target);
    fill_constraints(target);
    if (!machine_.bead_heights || find_member(document_, "tool", "thickness") != nullptr) return;
    const auto [least, most] = *machine_.bead_heights;
    const double of_target = unit_ * beads() / target;
    constexpr double rounding = 1e-9;
    if (of_target * least > 1.0 + rounding || of_target * most < 1.0 - rounding)
      refuse(found ? found->second : "/thermal/passes",
             formatted("layers of %g, which are %d bead%s of %.4g mm", target, beads(),
                       beads() == 1 ? "" : "s", target / (unit_ * beads())),
             formatted("beads of %g to %g mm, as bead_heights of the machine says", least, most));
    put("tool", "thickness", Json::array({plain(of_target * least), plain(of_target * most)}));
  }

  /// Gives constraints the numbers that the machine has for them.
  void fill_constraints(double target) {
    Json* constraints = find_member(document_, "constraints");
    if (constraints == nullptr || !constraints->is_array()) return;
    for (Json& constraint : *constraints) {
      const Json* found = find_member(constraint, "type");
      if (found == nullptr) continue;
      const Json type = *found;  // a new key moves those that are there
      if (type == "layer_thickness" && !constraint.contains("target")) constraint["target"] = target;
      if (type == "interpass_temperature" && !constraint.contains("limit") && machine_.interpass_limit)
        constraint["limit"] = *machine_.interpass_limit;
    }
  }

  void add_tool() {
    if (!machine_.name.empty()) put("tool", "name", machine_.name);
    if (!machine_.torch.empty()) {
      Json profile = Json::array();
      for (const auto& [height, radius] : machine_.torch)
        profile.push_back(Json::array({length(height), length(radius)}));
      put("tool", "profile", profile);
      put("tool", "clearance", length(machine_.clearance));
    }
    if (!machine_.tilts()) put("tool", "axis", plate_normal());
    if (machine_.tilt < all_directions) put("tool", "max_tilt", machine_.tilt);
    put("tool", "bead_width", length(machine_.bead_width));
    put("tool", "bead_height", length(machine_.bead_height));
    if (machine_.bridge) put("tool", "bridge", length(*machine_.bridge));
    if (machine_.travel_speed) put("tool", "travel_speed", length(*machine_.travel_speed));
    if (!machine_.plate.empty())
      put("tool", "plate", Json::array({length(machine_.plate[0]), length(machine_.plate[1])}));
  }

  /// The direction in which a torch stands on the plate.
  Json plate_normal() const {
    const Json* elements = find_member(document_, "domain", "elements");
    const std::size_t dimension =
        elements != nullptr && elements->is_array() && elements->size() == 2 ? 2 : 3;
    const Json* given = find_member(document_, "build_plate");
    const std::string plate = given != nullptr && given->is_string() ? given->get<std::string>() : "";
    std::size_t axis = std::string("xyz").find(plate.empty() ? ' ' : plate[0]);
    if (axis >= dimension) axis = dimension - 1;
    Json result = Json::array();
    for (std::size_t i = 0; i < dimension; ++i) result.push_back(0.0);
    result[axis] = plate.ends_with('+') ? -1.0 : 1.0;
    return result;
  }

  const MachineEntries& machine_;
  Json& document_;
  double unit_;  ///< of length of the config in a millimetre
};

}  // namespace

void add_machine_defaults(const MachineEntries& machine, Json& document) {
  MachineDefaults(machine, document).add();
}

}  // namespace fabseq
