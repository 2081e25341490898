// SPDX-License-Identifier: MIT
#include "fabseq/process/process_rules.h"

#include "fabseq/keys/config_key.h"

#include <algorithm>
#include <functional>
#include <string>

namespace fabseq {

namespace {

constexpr const char* model_key = "/process/model";
constexpr const char* flows = "\"elastoplastic\"";

}  // namespace

void check_curves(const MaterialSettings& material) {
  const std::vector<double>& temperatures = material.temperatures;
  if (std::ranges::adjacent_find(temperatures, std::greater_equal<>()) != temperatures.end())
    refuse("/material/temperatures", shown(Json(temperatures)),
           "temperatures that rise from one to the next");
  const auto check = [&](const char* key, const std::vector<double>& values) {
    if (!values.empty() && values.size() != temperatures.size())
      refuse(key, std::to_string(values.size()) + " numbers",
             "none, or as many as in /material/temperatures: " + std::to_string(temperatures.size()));
  };
  check("/material/young_factors", material.young_factors);
  check("/material/yield_factors", material.yield_factors);
  check("/material/elongations", material.elongations);
  check("/material/conductivity_factors", material.conductivity_factors);
  check("/material/heat_capacity_factors", material.heat_capacity_factors);
}

void check_process(const MaterialSettings& material, const ProcessSettings& process, bool has_temperature,
                   int dimension) {
  if (process.model == ProcessModel::linear) return;
  const std::string with_flow = std::string(" with process.model ") + flows;
  if (dimension != 3)
    refuse(model_key, std::string(flows) + " in two dimensions", "\"linear\", or three dimensions");
  if (process.deposition != DepositionModel::nominal)
    refuse("/process/deposition", "\"follow\"" + with_flow, "\"nominal\"");
  if (!material.yield_stress) refuse("/material/yield_stress", "\"none\"" + with_flow, "a number");
  if (!material.scenarios.empty())
    refuse("/material/scenarios", shown(Json(material.scenarios)) + with_flow,
           "[]: displacements are not linear in the strain");
  if (!has_temperature) return;
  if (material.elongations.empty())
    refuse("/material/elongations", "[]" + with_flow + " and a block thermal", "strains by temperature");
  if (!material.cut_off)
    refuse("/material/cut_off", "\"none\"" + with_flow + " and a block thermal", "a temperature");
}

}  // namespace fabseq
