// SPDX-License-Identifier: MIT
#include "fabseq/tasks/bead_checks.h"

#include "fabseq/base/error.h"
#include "fabseq/base/session.h"
#include "fabseq/layers/curved_layers.h"
#include "fabseq/responses/response_type.h"
#include "tasks/advice.h"
#include "tasks/config_changes.h"
#include "tasks/refined_time.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

/// Elements to a bead, docs/how-to/choose-what-to-optimize.md.
constexpr double least_per_bead = 2.5;
/// Finer grids take minutes and gigabytes for each sequence that is checked.
constexpr double most_elements = 4e6;

/// The config in real layers, on a grid so many times as fine.
template <int Dim>
Config in_real_layers(const Setup<Dim>& setup, int factor) {
  Config config = config_to_change(setup);
  if (config.layers.target) config.layers.given_target = config.layers.target->bead;
  cut_into_real_layers(config);
  refine(config, factor);
  config.baseline.best_direction = config.baseline.even = false;
  config.projection.binary = true;
  // A sequence from a file, as which its results go on, has no gradient for responses.
  std::erase_if(config.objective, [&](const Term& term) { return config.needs_time_gradient(*term.type); });
  config.part.announce = false;
  complete_derived(config);
  return config;
}

/// How often the grid is halved for enough elements to a bead, of which it has `per_bead`.
template <int Dim>
int halvings(const Setup<Dim>& setup, double per_bead) {
  int result = 0;
  auto elements = static_cast<double>(setup.part.count());
  while (std::ldexp(per_bead, result) < least_per_bead && elements * (1 << Dim) <= most_elements) {
    elements *= 1 << Dim;
    ++result;
  }
  return result;
}

}  // namespace

template <int Dim>
BeadChecks<Dim>::BeadChecks(const Setup<Dim>& setup) : simulated_(setup) {
  const double per_bead = elements_per_bead(setup);
  const int wanted = halvings(setup, per_bead);
  is_finer_ = wanted > 0;
  for (int level = is_finer_ ? 1 : 0; level <= wanted; ++level) {
    try {
      grids_.push_back(std::make_unique<Level>(setup.world(), in_real_layers(setup, 1 << level)));
    } catch (const InputError&) {
      if (grids_.empty()) throw;
      break;
    }
    grids_.back()->per_bead = std::ldexp(per_bead, level);
  }
}

template <int Dim>
const Setup<Dim>& BeadChecks<Dim>::for_bodies() const {
  const auto found =
      std::find_if(grids_.begin(), grids_.end(), [](const auto& grid) { return grid->per_bead >= 1.0; });
  return found == grids_.end() ? finest() : (*found)->setup;
}

template <int Dim>
RealSequence<Dim> BeadChecks<Dim>::checked(const PseudoTime<Dim>& time, const Layers& layers,
                                           std::vector<double> time_points, const Setup<Dim>& on) const {
  RealSequence<Dim> result;
  result.time = time;
  const Part<Dim>* part = &simulated_.part;
  for (const auto& grid : grids_) {
    // Gradients that went on with their slope would tilt and stretch by more than they do anywhere.
    if (is_finer_) result.time = refined_time(*part, result.time, grid->setup.part, BeyondCentres::value);
    part = &grid->setup.part;
    if (&grid->setup == &on) break;
  }
  LayerDensities densities;
  if (time_points.empty()) {
    layers.set_densities(result.time.time, densities);
  } else {  // checks need no densities, which take memory
    densities.stage.resize(time_points.size() - 1);
    densities.layer.resize(time_points.size() - 1);
    densities.time_points = std::move(time_points);
  }
  result.count = densities.count();
  result.layer = layers.layer_index(result.time.time, densities);
  result.sub_parts = densities.sub_parts;
  result.build = check_layers(on, result.time, densities, result.layer, /*with_places=*/true);
  return result;
}

template <int Dim>
RealSequence<Dim> BeadChecks<Dim>::cut(const PseudoTime<Dim>& time, std::span<const double> variables,
                                       const Setup<Dim>& on) const {
  const LayerModel<Dim>& model = *on.layers;
  if (on.config.layers.multi_planar) {
    RealSequence<Dim> result =
        checked(time, *model.make(variables, model.traits().last_beta, true, {}), {}, on);
    result.variables.assign(variables.begin(), variables.end());
    return result;
  }
  std::vector<double> inner = interpolated_time_points(variables, model.count()), points = {0.0};
  points.insert(points.end(), inner.begin(), inner.end());
  points.push_back(1.0);
  RealSequence<Dim> result =
      checked(time, CurvedLayers(on.part.part_density(), points, 1.0, true), points, on);
  result.variables = std::move(inner);
  return result;
}

template <int Dim>
RealSequence<Dim> BeadChecks<Dim>::judge(const PseudoTime<Dim>& time, std::span<const double> variables,
                                         SequenceReport& report) const {
  RealSequence<Dim> real = cut(time, variables, finest());
  replace(real, report);
  return real;
}

template <int Dim>
void BeadChecks<Dim>::judge(const PseudoTime<Dim>& time, int layers, SequenceReport& report) const {
  const std::vector<double> points = uniform_time_points(layers * simulated_.config.layers.passes);
  const CurvedLayers curved(finest().part.part_density(), points, 1.0, true);
  replace(checked(time, curved, points, finest()), report);
}

template <int Dim>
RealSequence<Dim> BeadChecks<Dim>::on_grid_for_bodies(RealSequence<Dim> judged, const PseudoTime<Dim>& time,
                                                      std::span<const double> variables) const {
  return &for_bodies() == &finest() ? std::move(judged) : cut(time, variables, for_bodies());
}

/// Puts what has been found of real layers in place of what a report has.
template <int Dim>
void BeadChecks<Dim>::replace(const RealSequence<Dim>& real, SequenceReport& report) const {
  const Index<Dim>& elements = finest().grid.domain().elements;
  report.real_layers = {simulated_.config.layers.passes,
                        real.count,
                        {elements.begin(), elements.end()},
                        grids_.back()->per_bead,
                        *report.verdict};
  report.found.replace(real.build.numbers);
  report.verdict = fabseq::judge(report.found, finest().settings);
}

template <int Dim>
std::unique_ptr<const BeadChecks<Dim>> make_bead_checks(const Setup<Dim>& setup) {
  const bool begins_another = setup.config.optimizer.later_iterations > 0;
  if (setup.config.layers.passes == 1 || begins_another) return nullptr;
  try {
    return std::make_unique<const BeadChecks<Dim>>(setup);
  } catch (const InputError& error) {
    warn(std::string("/layers/passes: checks and verdict are those of simulated layers: ") + error.what());
    return nullptr;
  }
}

FABSEQ_INSTANTIATE_CLASS(BeadChecks);
FABSEQ_INSTANTIATE_FUNCTION(make_bead_checks);

}  // namespace fabseq
