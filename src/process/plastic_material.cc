// SPDX-License-Identifier: MIT
#include "process/plastic_material.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

constexpr int strain_count = ElementModes::strains;
using EightNumbers = std::array<double, plastic_width>;

/// Interpolation of the yield stress of an element with this density, and its slope: density^2.5, but for a
/// least value that keeps void from yielding.
constexpr double least_yield = 1e-4;
double yield_share(double density) {
  const double positive = std::max(density, 0.0);
  return least_yield + (1.0 - least_yield) * positive * positive * std::sqrt(positive);
}
double yield_share_slope(double density) {
  const double positive = std::max(density, 0.0);
  return (1.0 - least_yield) * 2.5 * positive * std::sqrt(positive);
}

}  // namespace

PlasticMaterial::PlasticMaterial(const ElasticModel<3>& model, const PlasticBatches& batches,
                                 const PlasticInput& input)
    : model_(model),
      batches_(batches),
      input_(input),
      curves_(model.material),
      yield_(model.material.yield_stress.value() / model.material.young),
      hardening_(model.material.hardening / model.material.young) {}

std::vector<PlasticPoint> PlasticMaterial::start() const {
  std::vector<PlasticPoint> result(batches_.count());
  for (std::size_t batch = 0; batch < result.size(); ++batch) {
    PlasticPoint& point = result[batch];
    for (PlasticLanes& value : point.stress) value = PlasticLanes::zero();
    for (PlasticLanes& value : point.hourglass) value = PlasticLanes::zero();
    point.plastic_strain = PlasticLanes::zero();
    point.modulus = PlasticLanes::broadcast(1.0);
    EightNumbers stiffness{}, elongation{};
    for (std::size_t e = 0; e < batches_.batch(batch).size(); ++e) {
      const int element = batches_.batch(batch)[e];
      const bool stands = model_.part_element[element] < 0 && model_.stage_density({}, element) > 0.0;
      stiffness[e] = model_.stiffness(stands ? 1.0 : 0.0);
      if (input_.heated() && stands) elongation[e] = curves_.elongation(input_.temperatures->plate);
    }
    point.stiffness = PlasticLanes::load(stiffness.data());
    point.elongation = PlasticLanes::load(elongation.data());
  }
  return result;
}

void PlasticMaterial::set_wave(const PlasticWave& wave) {
  wave_ = wave;
  values_.resize(batches_.count() * wave.count);
  for (std::size_t batch = 0; batch < batches_.count(); ++batch)
    for (int step = 0; step < wave.count; ++step) set_values(batch, step, values_[batch * wave.count + step]);
  if (!input_.heated()) set_strains();
}

void PlasticMaterial::set_values(std::size_t batch, int step, Values& values) const {
  const std::size_t number = number_of(step);
  const int layer = input_.steps[number].layer;
  EightNumbers modulus, stiffness, yield, elongation{}, load{};
  modulus.fill(1.0);
  stiffness.fill(1.0);
  yield.fill(1.0);
  for (std::size_t e = 0; e < batches_.batch(batch).size(); ++e) {
    const int element = batches_.batch(batch)[e], part_element = model_.part_element[element];
    const double own = density(number, element);
    stiffness[e] = model_.stiffness(own);
    yield[e] = yield_share(own);
    if (adds(step) && part_element >= 0) load[e] = model_.load(input_.densities.layer[layer][part_element]);
    if (!input_.heated()) continue;
    const double temperature = input_.temperatures->elements[number][element];
    modulus[e] = curves_.young(temperature);
    yield[e] *= curves_.yield(temperature);
    elongation[e] = curves_.elongation(temperature);
  }
  values = {PlasticLanes::load(modulus.data()), PlasticLanes::load(stiffness.data()),
            PlasticLanes::load(yield.data()), PlasticLanes::load(elongation.data()),
            PlasticLanes::load(load.data())};
}

/// Sets the strains of steps, which all add a layer where there are no temperatures.
void PlasticMaterial::set_strains() {
  strains_.clear();
  if (wave_.release) return;
  std::array<double, strain_count> strain{};
  if (input_.strains.variation() != StrainVariation::by_element) {
    const int any = 0;
    for (int step = 0; step < wave_.count; ++step) {
      input_.strains.set_strains({&any, 1}, {wave_.first + step, 1}, strain);
      Voigt& to = strains_.emplace_back();
      for (int c = 0; c < strain_count; ++c) to[c] = PlasticLanes::broadcast(strain[c]);
    }
    return;
  }
  for (std::size_t batch = 0; batch < batches_.count(); ++batch)
    for (int step = 0; step < wave_.count; ++step) {
      std::array<EightNumbers, strain_count> values{};
      for (std::size_t e = 0; e < batches_.batch(batch).size(); ++e) {
        const int part_element = model_.part_element[batches_.batch(batch)[e]];
        if (part_element < 0) continue;
        input_.strains.set_strains({&part_element, 1}, {wave_.first + step, 1}, strain);
        for (int c = 0; c < strain_count; ++c) values[c][e] = strain[c];
      }
      Voigt& to = strains_.emplace_back();
      for (int c = 0; c < strain_count; ++c) to[c] = PlasticLanes::load(values[c].data());
    }
}

void PlasticMaterial::add_derivatives(std::size_t batch, int step, const PlasticStepDerivatives& derivatives,
                                      const ProcessDerivatives& to) const {
  const std::size_t number = number_of(step), part_elements = model_.part_position.size();
  const int layer = input_.steps[number].layer;
  auto& d_stage = DensityDerivatives::zeros_if_empty(to.densities->stage[layer], part_elements);
  std::vector<double>* d_layer =
      adds(step) ? &DensityDerivatives::zeros_if_empty(to.densities->layer[layer], part_elements) : nullptr;
  std::vector<double>* d_before =
      number > 0 && input_.heated() ? &DensityDerivatives::zeros_if_empty(
                                          to.densities->stage[input_.steps[number - 1].layer], part_elements)
                                    : nullptr;
  for (std::size_t lane = 0; lane < batches_.batch(batch).size(); ++lane) {
    const int element = batches_.batch(batch)[lane], part_element = model_.part_element[element];
    const auto e = static_cast<int>(lane);
    const double own = density(number, element),
                 of_share = yield_ * derivatives.yield[e] + hardening_ * derivatives.hardening[e];
    double yield_factor = 1.0;
    if (input_.heated()) {
      const double temperature = input_.temperatures->elements[number][element];
      yield_factor = curves_.yield(temperature);
      double of_elongation = derivatives.elongation[e];
      for (int a = 0; a < 3; ++a) of_elongation += derivatives.inherent_strain[a][e];
      if (to.temperatures != nullptr)
        (*to.temperatures)[number][element] +=
            derivatives.modulus[e] * curves_.young_slope(temperature) +
            yield_share(own) * of_share * curves_.yield_slope(temperature) +
            of_elongation * curves_.elongation_slope(temperature);
    }
    if (part_element < 0) continue;
    d_stage[part_element] += model_.stiffness_derivative(own) * derivatives.stiffness[e] +
                             yield_share_slope(own) * yield_factor * of_share;
    if (d_before != nullptr)
      (*d_before)[part_element] +=
          model_.stiffness_derivative(density(number - 1, element)) * derivatives.stiffness_before[e];
    if (d_layer == nullptr) continue;
    (*d_layer)[part_element] +=
        model_.load_derivative(input_.densities.layer[layer][part_element]) * derivatives.load[e];
    if (to.strains == nullptr || input_.heated()) continue;
    std::array<double, strain_count> d_strain;
    for (int c = 0; c < strain_count; ++c) d_strain[c] = derivatives.inherent_strain[c][e];
    input_.strains.add_derivatives({&part_element, 1}, {static_cast<int>(number), 1}, d_strain, *to.strains);
  }
}

}  // namespace fabseq
