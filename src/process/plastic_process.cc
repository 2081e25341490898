// SPDX-License-Identifier: MIT
#include "fabseq/process/plastic_process.h"

#include "fabseq/base/formatted.h"
#include "process/plastic_adjoint.h"
#include "process/plastic_sweeps.h"
#include "process/step_results.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Sweeps end when they change the displacements by less than this share of the tolerance.
constexpr double share_of_tolerance = 0.1;

}  // namespace

PlasticProcess::~PlasticProcess() = default;

PlasticProcess::PlasticProcess(const ElasticModel<3>& model, std::unique_ptr<ElasticitySolver<3>> solver,
                               const LayerGroups& groups, BlockSolver blocks, int lanes)
    : Process<3>(model, std::move(solver), groups, blocks, lanes) {}

const ProcessResult& PlasticProcess::simulate(const ProcessInput<3>& input) {
  strains_ = &input.strains;
  systems_.deal_out(input.densities, input.steps);
  forward_ = std::make_unique<PlasticSweeps>(systems_, release_.get(), input.densities, input.strains,
                                             input.temperatures);
  PlasticSweeps& sweeps = *forward_;
  sweeps_ = sweeps.run(share_of_tolerance * tolerance_);
  set_steps(systems_, result_);
  const std::vector<LaneVector> increments = sweeps.increments();
  groups().run([&] {
    for (std::size_t block = 0; block < increments.size(); ++block) {
      pick(increments[block], result_.nodes[block], result_.increments[block]);
      count_block(deposition_.get(), input.densities, block, result_);
    }
  });
  sum_displacements(groups(), result_);
  result_.iterations.assign(systems_.steps().size(), sweeps_);
  result_.release = sweeps.release();
  built_ = gathered(sweeps.built().stress, sweeps.built().plastic_strain);
  released_ = gathered(sweeps.released().stress, sweeps.released().plastic_strain);
  return result_;
}

void PlasticProcess::pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                               std::span<const ProcessDerivatives> derivatives) {
  adjoint_iterations_.assign(result_.steps.size(), 0);
  for (std::size_t k = 0; k < functionals.size(); ++k) {
    PlasticAdjoint adjoint(systems_, release_.get(), *forward_, result_, functionals[k]);
    const int sweeps = adjoint.run(share_of_tolerance * tolerance_);
    for (int& iterations : adjoint_iterations_) iterations = std::max(iterations, sweeps);
    groups().run([&] { add_derivatives(densities, adjoint, functionals[k], derivatives[k]); });
  }
}

/// Of this rank's share of the elements, in all steps, and through the weights of this group's steps.
void PlasticProcess::add_derivatives(const LayerDensities& densities, const PlasticAdjoint& adjoint,
                                     const ProcessAdjoint& functional, const ProcessDerivatives& to) const {
  const std::size_t steps = result_.steps.size(), elements = model().part_position.size(),
                    first = forward_->elements().first_element(),
                    count = forward_->elements().elements_of_share();
  const PlasticDerivatives& found = adjoint.derivatives();
  for (std::size_t s = 0; s < steps; ++s) {
    const int layer = result_.steps[s].layer;
    auto& d_stage = DensityDerivatives::zeros_if_empty(to.densities->stage[layer], elements);
    auto& d_layer = DensityDerivatives::zeros_if_empty(to.densities->layer[layer], elements);
    std::vector<double>* d_before =
        s > 0 ? &DensityDerivatives::zeros_if_empty(to.densities->stage[result_.steps[s - 1].layer], elements)
              : nullptr;
    for (std::size_t e = 0; e < count; ++e) {
      const int part_element = model().part_element[first + e];
      if (part_element < 0) continue;
      d_stage[part_element] += found.stage[e * steps + s];
      d_layer[part_element] += found.layer[e * steps + s];
      if (d_before != nullptr) (*d_before)[part_element] += found.stage_before[e * steps + s];
    }
  }
  if (to.strains != nullptr && forward_->input().temperatures == nullptr) {
    to.strains->resize(strains_->input_count(), 0.0);
    for (std::size_t e = 0; e < count; ++e) {
      const int part_element = model().part_element[first + e];
      for (std::size_t s = 0; part_element >= 0 && s < steps; ++s)
        strains_->add_derivatives(
            {&part_element, 1}, {static_cast<int>(s), 1},
            std::span(found.strains).subspan((e * steps + s) * voigt_size<3>, voigt_size<3>), *to.strains);
    }
  }
  if (to.temperatures != nullptr && forward_->input().temperatures != nullptr)
    add_temperatures(found, *to.temperatures);
  for (std::size_t block = 0; deposition_ && block < result_.blocks.size(); ++block) {
    std::vector<Deposition<3>::Missing> missing;
    for (const BuildStep& step : result_.steps_of(block))
      missing.push_back(deposition_->missing(densities.stage[step.layer]));
    deposition_->add_derivatives(missing, result_.steps_of(block), result_.nodes[block],
                                 weight_derivatives(functional, result_, block, result_.increments[block]),
                                 *to.densities);
  }
  if (to.sink != nullptr) to.sink->flush();
}

/// Through modulus, yield stress and elongation.
void PlasticProcess::add_temperatures(const PlasticDerivatives& found,
                                      std::vector<std::vector<double>>& to) const {
  const MaterialCurves& curves = forward_->history().curves();
  const std::size_t steps = result_.steps.size(), first = forward_->elements().first_element();
  to.resize(steps);
  for (std::size_t s = 0; s < steps; ++s) {
    const std::vector<double>& temperatures = forward_->input().temperatures->elements[s];
    to[s].resize(temperatures.size(), 0.0);
    for (std::size_t e = 0; e < forward_->elements().elements_of_share(); ++e) {
      const double temperature = temperatures[first + e];
      const std::size_t at = e * steps + s;
      to[s][first + e] += found.modulus[at] * curves.young_slope(temperature) +
                          found.yield[at] * curves.yield_slope(temperature) +
                          found.elongation[at] * curves.elongation_slope(temperature);
    }
  }
}

std::string PlasticProcess::description() const {
  return systems_.solver_description() + formatted("; %d sweeps of plastic flow", sweeps_);
}

LockedIn PlasticProcess::gathered(const std::vector<double>& stress,
                                  const std::vector<double>& plastic_strain) const {
  const auto owned = static_cast<std::size_t>(model().part.grid().owned_elements().count());
  const auto spread = [&](const std::vector<double>& share, double factor, std::size_t components,
                          std::size_t c, std::vector<double>& to) {
    const std::vector<double> all = groups().gather(share);
    for (std::size_t e = 0; e < all.size(); ++e)
      to[static_cast<std::size_t>(model().elements[e]) * components + c] = factor * all[e];
  };
  LockedIn result{std::vector<double>(owned * voigt_size<3>, 0.0), std::vector<double>(owned, 0.0)};
  std::vector<double> component(plastic_strain.size());
  for (int c = 0; c < voigt_size<3>; ++c) {
    for (std::size_t e = 0; e < component.size(); ++e) component[e] = stress[e * voigt_size<3> + c];
    spread(component, model().material.young, voigt_size<3>, c, result.stress);
  }
  spread(plastic_strain, 1.0, 1, 0, result.plastic_strain);
  return result;
}

}  // namespace fabseq
