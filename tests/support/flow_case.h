// SPDX-License-Identifier: MIT
/// \file
/// A small process with plastic flow, and the material of its elements in each step once more
/// (formulation 16).
#pragma once

#include "fabseq/process/plastic_process.h"
#include "support/newton_flow.h"
#include "support/process_case.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace fabseq::test {

/// Solves directly; `released`: with a release in the end.
inline std::unique_ptr<PlasticProcess> plastic_process(const ProcessCase<3>& process, double tolerance,
                                                       bool released) {
  auto solver = std::make_unique<ReferenceElasticity<3>>(process.grid(), process.model.domain,
                                                         process.model.element.stiffness(), exact_solver);
  auto result = std::make_unique<PlasticProcess>(process.model, std::move(solver), process.groups,
                                                 BlockSolver::one_by_one);
  if (released) result->release_with({exact_solver});
  result->set_tolerance({tolerance});
  return result;
}

/// A gallows that yields at a tenth of its inherent strain.
inline CaseSettings<3> flowing_case() {
  CaseSettings<3> result;
  result.process.deposition = DepositionModel::nominal;
  result.material.young = 200.0;
  result.material.yield_stress = 0.2;
  result.material.hardening = 5.0;
  return result;
}

/// The same on a substrate that clamps hold, of a material that follows its temperature.
inline CaseSettings<3> heated_case() {
  CaseSettings<3> result = flowing_case();
  const CaseSettings<3> clamped = clamped_cases<3>().front();
  result.substrate = clamped.substrate;
  result.clamps = clamped.clamps;
  result.material.temperatures = {20.0, 600.0, 1200.0};
  result.material.young_factors = {1.0, 0.5, 0.02};
  result.material.yield_factors = {1.0, 0.4, 0.03};
  result.material.elongations = {0.0, 0.008, 0.017};
  result.material.cut_off = 1100.0;
  return result;
}

/// Steps, densities and temperatures of a process, and the material that these lead to.
struct FlowCase {
  FlowCase(const CaseSettings<3>& settings, int layer_count, double beta)
      : process(settings), layers(process.densities(process.wavy_time(), layer_count, beta)) {
    heated = !settings.material.temperatures.empty();
    steps = heated ? ProcessCase<3>::cooling_steps(layer_count) : steps_of_layers(layer_count);
    if (heated) set_temperatures();
    set_materials();
  }

  /// What the process is given of the first steps.
  ProcessInput<3> input(std::size_t count) const {
    return {layers,
            process.strain,
            {steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(count)},
            heated ? &temperatures : nullptr};
  }
  std::vector<char> held() const {
    std::vector<char> result;
    process.grid().all_nodes().for_each(
        [&](const Index<3>& node, std::int64_t) { result.push_back(process.is_held(node) ? 1 : 0); });
    return result;
  }

  ProcessCase<3> process;
  LayerDensities layers;
  bool heated;
  std::vector<BuildStep> steps;
  StepTemperatures temperatures{{}, plate_temperature};
  std::vector<std::vector<FlowMaterial>> materials;  ///< [step, and the release][element of the grid]

 private:
  static constexpr double plate_temperature = 150.0, air = 20.0;

  /// Temperature of an element of the grid at the end of a step: new layers are hot, with some noise, and
  /// cool in the pause; in the end all is as cold as the air.
  double temperature(std::size_t step, std::int64_t element) const {
    if (step + 1 == steps.size()) return air;
    const Point<3> center = process.grid().element_center(process.grid().all_elements().index(element));
    const double built = (steps[step].layer + 1.0) / layers.count(),
                 height = process.height(center) / process.grid().domain().size[2],
                 above = air + (steps[step].adds ? 1250.0 : 500.0) * (0.8 + 0.2 * noise(element));
    return air + (above - air) * std::exp(-3.0 * std::abs(built - height));
  }
  void set_temperatures() {
    for (std::size_t step = 0; step < steps.size(); ++step) {
      auto& to = temperatures.elements.emplace_back();
      for (const int element : process.model.elements)
        to.push_back(temperature(
            step, process.grid().all_elements().offset(process.grid().owned_elements().index(element))));
    }
  }
  /// Linear between the points of the table, constant beyond.
  double curve(const std::vector<double>& values, double at) const {
    const std::vector<double>& x = process.settings.material.temperatures;
    if (at <= x.front()) return values.front();
    for (std::size_t i = 1; i < x.size(); ++i)
      if (at <= x[i])
        return values[i - 1] + (values[i] - values[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
    return values.back();
  }
  double elongation(double at) const {
    const MaterialSettings& material = process.settings.material;
    return curve(material.elongations, std::min(at, *material.cut_off));
  }
  void set_materials() {
    const std::int64_t count = process.grid().all_elements().count();
    std::vector<FlowMaterial> current(count);
    std::vector<double> factor(count, 1.0), stiffness(count, 0.0), length(count, 0.0);  // of the step before
    const auto& substrate = process.part().substrate().elements();
    const auto base =
        whole_element_field<3>(process.grid(), std::vector<double>(substrate.begin(), substrate.end()));
    for (std::int64_t e = 0; e < count; ++e) {
      stiffness[e] = stiffness_share(base[e]);
      length[e] = heated && base[e] != 0.0 ? elongation(plate_temperature) : 0.0;
    }
    for (std::size_t step = 0; step < steps.size(); ++step) {
      const auto density = whole_part_field(process.part(), layers.stage[steps[step].layer], -1.0),
                 added = whole_part_field(process.part(), layers.layer[steps[step].layer]);
      for (std::int64_t e = 0; e < count; ++e) {
        const double own = base[e] != 0.0 ? 1.0 : density[e];
        if (own < 0.0 && process.settings.process.void_model == VoidModel::absent) continue;
        const Change change{own, steps[step].adds ? std::pow(std::max(added[e], 0.0), 3.0) : 0.0,
                            heated ? temperature(step, e) : air, step == 0};
        current[e] = material(change, factor[e], stiffness[e], length[e]);
      }
      materials.push_back(current);
    }
    for (FlowMaterial& of_release : current) {
      of_release.ratio = 1.0;
      of_release.load = {};
    }
    materials.push_back(current);
  }
  double stiffness_share(double density) const {
    return 1e-9 + (1.0 - 1e-9) * std::pow(std::max(density, 0.0), 3.0);
  }
  struct Change {
    double density, added, temperature;
    bool first;
  };
  /// Material of an element in a step; takes f, a and g from the step before to this one.
  FlowMaterial material(const Change& change, double& factor, double& stiffness, double& length) const {
    const MaterialSettings& of = process.settings.material;
    FlowMaterial result;
    const double factor_before = factor, stiffness_before = stiffness, length_before = length;
    factor = heated ? curve(of.young_factors, change.temperature) : 1.0;
    stiffness = stiffness_share(change.density);
    length = heated ? elongation(change.temperature) : 0.0;
    result.young = of.young * factor * stiffness;
    result.ratio = change.first ? 1.0 : factor / factor_before;
    const double share = (1e-4 + (1.0 - 1e-4) * std::pow(std::max(change.density, 0.0), 2.5)) *
                         (heated ? curve(of.yield_factors, change.temperature) : 1.0);
    result.yield = share * *of.yield_stress;
    result.hardening = share * of.hardening;
    for (int c = 0; c < 6; ++c) {
      const double normal = c < 3 ? 1.0 : 0.0,
                   strain = heated ? normal * (length - elongation(*of.cut_off)) : of.inherent_strain[c];
      result.load[c] =
          of.young * factor * (change.added * strain + stiffness_before * (length - length_before) * normal);
    }
    return result;
  }
};

}  // namespace fabseq::test
