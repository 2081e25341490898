// SPDX-License-Identifier: MIT
#include "process/plastic_history.h"

#include "process/element_modes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

constexpr int strains = ElementModes::strains;
constexpr int components = ElementModes::components;

/// Interpolation of the yield stress, whose least value keeps void from yielding.
constexpr double least_yield = 1e-4, yield_exponent = 2.5;
double yield_share(double density) {
  return least_yield + (1.0 - least_yield) * std::pow(std::max(density, 0.0), yield_exponent);
}

using Voigt = std::array<double, strains>;

Voigt deviator(const Voigt& stress) {
  Voigt result = stress;
  const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
  for (int a = 0; a < 3; ++a) result[a] -= mean;
  return result;
}

/// sqrt(3/2 d:d).
double equivalent(const Voigt& d) {
  double square = 0.0;
  for (int a = 0; a < 3; ++a) square += 1.5 * d[a] * d[a] + 3.0 * d[3 + a] * d[3 + a];
  return std::sqrt(square);
}

}  // namespace

/// State of an element on its way through the steps.
struct PlasticHistory::Point {
  Voigt stress{};
  double plastic_strain = 0.0;
  std::array<double, ElementModes::amplitudes> hourglass{};
  // Of the step before.
  double modulus = 1.0;     ///< f
  double stiffness = 0.0;   ///< a
  double elongation = 0.0;  ///< g
};

/// Material of an element in a step.
struct PlasticHistory::Step {
  double modulus = 1.0, stiffness = 1.0, yield = 0.0, hardening = 0.0;
  double elongation = 0.0;
  double load = 0.0;        ///< (drho)^q
  Voigt inherent_strain{};  ///< of new material
};

PlasticHistory::PlasticHistory(const ElasticModel<3>& model)
    : model_(model),
      curves_(model.material),
      yield_(model.material.yield_stress.value() / model.material.young),
      hardening_(model.material.hardening / model.material.young) {}

void PlasticHistory::set_step(const Input& input, std::size_t model_element, std::size_t number,
                              Step& step) const {
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
  } else if (step.load != 0.0) {
    input.strains.set_strains({&part_element, 1}, {static_cast<int>(number), 1}, step.inherent_strain);
  }
  const double share = yield_share(density) * yield_factor;
  step.yield = share * yield_;
  step.hardening = share * hardening_;
}

/// Takes a point through a step, by radial return.
void PlasticHistory::advance(const Step& step, const double* displacement, Point& point) const {
  const double ratio = step.modulus / point.modulus;  // of nothing before the first step
  const double young = step.modulus * step.stiffness;
  Voigt strain;
  for (int c = 0; c < strains; ++c)
    strain[c] = young * displacement[c] - step.modulus * step.load * step.inherent_strain[c];
  const double growth = step.modulus * point.stiffness * (step.elongation - point.elongation);
  for (int a = 0; a < 3; ++a) strain[a] -= growth;
  const Voigt elastic = model_.element.stress(strain);
  Voigt trial;
  for (int c = 0; c < strains; ++c) trial[c] = ratio * point.stress[c] + elastic[c];
  const Voigt d = deviator(trial);
  const double q = equivalent(d), shear = 3.0 * young / (2.0 * (1.0 + model_.material.poisson));
  const double flow =
      std::max(0.0, (q - step.yield - step.hardening * point.plastic_strain) / (shear + step.hardening));
  const double share = flow > 0.0 ? shear * flow / q : 0.0;
  for (int c = 0; c < strains; ++c) point.stress[c] = trial[c] - share * d[c];
  point.plastic_strain += flow;
  for (int k = 0; k < ElementModes::amplitudes; ++k)
    point.hourglass[k] = ratio * point.hourglass[k] + young * displacement[strains + k];
  point.modulus = step.modulus;
  point.stiffness = step.stiffness;
  point.elongation = step.elongation;
}

void PlasticHistory::run(const Input& input, Output& output) const {
  const std::size_t steps = input.steps.size();
  const std::size_t elements = input.displacements.size() / (steps * components);
  output.forces.resize(input.displacements.size());
  output.at_end.resize(elements * components);
  for (PlasticState* state : {&output.built, &output.released}) {
    state->stress.resize(elements * strains);
    state->plastic_strain.resize(elements);
  }
  const auto keep = [](std::size_t e, const Point& point, PlasticState& state) {
    std::ranges::copy(point.stress, state.stress.begin() + static_cast<std::ptrdiff_t>(e * strains));
    state.plastic_strain[e] = point.plastic_strain;
  };
  const auto store = [](const Point& point, double* to) {
    std::ranges::copy(point.hourglass, std::ranges::copy(point.stress, to).out);
  };
  for (std::size_t e = 0; e < elements; ++e) {
    const std::size_t model_element = input.first_element + e;
    Point point;
    const bool stands =
        model_.part_element[model_element] < 0 && model_.stage_density({}, model_element) > 0.0;
    point.stiffness = model_.stiffness(stands ? 1.0 : 0.0);
    if (input.temperatures != nullptr && stands)
      point.elongation = curves_.elongation(input.temperatures->plate);
    Step step;
    for (std::size_t s = 0; s < steps; ++s) {
      set_step(input, model_element, s, step);
      const double* displacement = &input.displacements[(e * steps + s) * components];
      double* force = &output.forces[(e * steps + s) * components];
      std::array<double, components> increment, before;
      for (int c = 0; c < components; ++c)
        increment[c] = displacement[c] - (input.accumulated && s > 0 ? displacement[c - components] : 0.0);
      store(point, before.data());
      advance(step, increment.data(), point);
      store(point, force);
      for (int c = 0; !input.accumulated && c < components; ++c) force[c] -= before[c];
    }
    keep(e, point, output.built);
    if (!input.release.empty()) {
      step.load = 0.0;
      advance(step, &input.release[e * components], point);
    }
    keep(e, point, output.released);
    store(point, &output.at_end[e * components]);
  }
}

}  // namespace fabseq
