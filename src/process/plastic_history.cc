// SPDX-License-Identifier: MIT
#include "process/plastic_history.h"

#include "process/element_modes.h"

#include <algorithm>
#include <array>

namespace fabseq {

PlasticHistory::PlasticHistory(const ElasticModel<3>& model)
    : model_(model),
      curves_(model.material),
      yield_(model.material.yield_stress.value() / model.material.young),
      hardening_(model.material.hardening / model.material.young) {}

void PlasticHistory::set_step(const PlasticInput& input, std::size_t model_element, std::size_t number,
                              PlasticStep& step) const {
  const BuildStep& build = input.steps[number];
  const double density = model_.stage_density(input.densities.stage[build.layer], model_element);
  const int part_element = model_.part_element[model_element];
  step.stiffness = model_.stiffness(density);
  step.load =
      build.adds && part_element >= 0 ? model_.load(input.densities.layer[build.layer][part_element]) : 0.0;
  double yield_factor = 1.0;
  step.modulus = 1.0;
  if (input.temperatures != nullptr) {
    const double temperature = input.temperatures->elements[number][model_element];
    step.modulus = curves_.young(temperature);
    yield_factor = curves_.yield(temperature);
    step.elongation = curves_.elongation(temperature);
    step.inherent_strain.fill(0.0);
    std::fill_n(step.inherent_strain.begin(), 3, step.elongation - curves_.first_elongation());
  } else if (build.adds && part_element >= 0) {
    input.strains.set_strains({&part_element, 1}, {static_cast<int>(number), 1}, step.inherent_strain);
  }
  const double share = YieldShare::of(density) * yield_factor;
  step.yield = share * yield_;
  step.hardening = share * hardening_;
}

PlasticPoint PlasticHistory::start(const PlasticInput& input, std::size_t model_element) const {
  PlasticPoint point;
  const bool stands = model_.part_element[model_element] < 0 && model_.stage_density({}, model_element) > 0.0;
  point.stiffness = model_.stiffness(stands ? 1.0 : 0.0);
  if (input.temperatures != nullptr && stands)
    point.elongation = curves_.elongation(input.temperatures->plate);
  return point;
}

void PlasticHistory::run(const PlasticInput& input, const Displacements& displacements,
                         Output& output) const {
  constexpr int components = ElementModes::components;
  const std::size_t steps = input.steps.size(), elements = displacements.steps.size() / (steps * components);
  output.forces.resize(displacements.steps.size());
  output.at_end.resize(elements * components);
  for (PlasticState* state : {&output.built, &output.released}) {
    state->stress.resize(elements * ElementModes::strains);
    state->plastic_strain.resize(elements);
  }
  const auto keep = [](std::size_t e, const PlasticPoint& point, PlasticState& state) {
    std::ranges::copy(point.stress,
                      state.stress.begin() + static_cast<std::ptrdiff_t>(e * ElementModes::strains));
    state.plastic_strain[e] = point.plastic_strain;
  };
  const auto store = [](const PlasticPoint& point, double* to) {
    std::ranges::copy(point.hourglass, std::ranges::copy(point.stress, to).out);
  };
  for (std::size_t e = 0; e < elements; ++e) {
    const std::size_t model_element = displacements.first_element + e;
    PlasticPoint point = start(input, model_element);
    PlasticStep step;
    for (std::size_t s = 0; s < steps; ++s) {
      set_step(input, model_element, s, step);
      const double* displacement = &displacements.steps[(e * steps + s) * components];
      double* force = &output.forces[(e * steps + s) * components];
      std::array<double, components> increment, before;
      for (int c = 0; c < components; ++c)
        increment[c] =
            displacement[c] - (displacements.accumulated && s > 0 ? displacement[c - components] : 0.0);
      store(point, before.data());
      advance(model_.element, model_.material.poisson, step, increment.data(), point);
      store(point, force);
      for (int c = 0; !displacements.accumulated && c < components; ++c) force[c] -= before[c];
    }
    keep(e, point, output.built);
    if (!displacements.release.empty()) {
      step.load = 0.0;
      advance(model_.element, model_.material.poisson, step, &displacements.release[e * components], point);
    }
    keep(e, point, output.released);
    store(point, &output.at_end[e * components]);
  }
}

}  // namespace fabseq
