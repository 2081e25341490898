// SPDX-License-Identifier: MIT
/// The changes of the sensitivity table.
#include "fabseq/base/formatted.h"
#include "fabseq/base/memory.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "tasks/advice.h"
#include "tasks/config_changes.h"
#include "tasks/variation.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// "+10 %", "-10 %"
std::string percent(double factor) { return formatted("%+.0f %%", 100.0 * (factor - 1.0)); }

using Change = std::function<void(Config&)>;

struct List {
  std::vector<Variation> variations = {};

  Variation& add(const std::string& name, Change change) {
    return variations.emplace_back(Variation{name, std::move(change)});
  }
};

/// Components of a strain that is fixed; of one that turns with the layers, the factors of its axes.
void add_strains(List& list, const Config& config) {
  const bool turns = config.material.turning_strain.has_value();
  const std::vector<std::string> names = config.dimension() == 2
                                             ? std::vector<std::string>{"xx", "yy", "xy"}
                                             : std::vector<std::string>{"xx", "yy", "zz", "xy", "yz", "zx"};
  const auto member = turns ? &MaterialSettings::strain_scale : &MaterialSettings::inherent_strain;
  const std::vector<double>& values = config.material.*member;
  for (std::size_t c = 0; c < values.size(); ++c)
    for (const double factor : {1.0 + size_of_change, 1.0 - size_of_change}) {
      if (values[c] == 0.0) continue;
      const std::string of = turns ? "strain, factor of axis " + names[c].substr(0, 1) : "strain " + names[c];
      list.add(of + " " + percent(factor),
               [member, c, factor](Config& its) { (its.material.*member)[c] *= factor; });
    }
}

void add_poisson(List& list, const Config& config) {
  const double poisson = config.material.poisson;
  if (poisson == 0.0) return;
  for (const double factor : {1.0 + size_of_change, 1.0 - size_of_change}) {
    // A material may come near 0.5, at which it has no more room to give.
    const double value = std::min(factor * poisson, 0.5 * (poisson + 0.5));
    list.add(formatted("Poisson's ratio %.3g", value),
             [value](Config& its) { its.material.poisson = value; });
  }
}

/// Adds variations of layers whose number follows from their thickness.
void add_thicknesses(List& list, double thickness, int baseline_layers) {
  const auto add = [&](const char* name, double factor) {
    list.add(formatted(name, factor * thickness), [=](Config& its) {
      its.layers.multi_planar->thickness = factor * thickness;
      its.baseline.layers = std::max(1, static_cast<int>(std::lround(baseline_layers / factor)));
    });
  };
  add("layers 10 %% thicker: %.4g", 1.0 + size_of_change);
  add("layers 10 %% thinner: %.4g", 1.0 - size_of_change);
  add("layers half as thick: %.4g", 0.5);
}

void refine_once(Config& config) { refine(config, 2); }

void set_layers(Config& config, int layers, int baseline_layers) {
  config.layers.count = layers;
  config.baseline.layers = std::max(1, baseline_layers);
}

/// `elements_per_layer`: thickness of a layer in elements.
void add_layers(List& list, int layers, int baseline_layers, double elements_per_layer) {
  const auto add = [&](const std::string& name, int count, int baseline) {
    list.add(name + ": " + std::to_string(count), [=](Config& its) { set_layers(its, count, baseline); });
  };
  // Of layers thinner than an element, some planar ones are empty.
  const auto add_times = [&](const char* name, int factor) {
    const bool finer = elements_per_layer < factor;
    list.add(formatted("%s: %d%s", name, factor * layers, finer ? ", grid twice as fine" : ""),
             [=](Config& its) {
               set_layers(its, factor * layers, factor * baseline_layers);
               if (finer) refine_once(its);
             })
        .layers_times = factor;
    list.variations.back().finer = finer;
  };
  if (layers > 1) add("one layer less", layers - 1, baseline_layers - 1);
  add("one layer more", layers + 1, baseline_layers + 1);
  add_times("layers doubled", 2);
  add_times("layers quadrupled", 4);
}

}  // namespace

template <int Dim>
std::vector<Variation> all_variations(const Setup<Dim>& setup) {
  const Config& config = setup.config;
  List list;
  list.add("unchanged", [](Config&) {});
  add_strains(list, config);
  add_poisson(list, config);
  if (config.layers.multi_planar)
    add_thicknesses(list, config.layers.multi_planar->thickness, setup.baseline->count());
  else
    add_layers(list, setup.layers->count(), setup.baseline->count(),
               elements_per_layer(setup, geodesic_height(setup.part, geodesic_distance(setup.part))));
  list.add("layers smooth, as optimized", [](Config&) {}).smooth = true;
  list.add("grid twice as fine", refine_once).finer = true;
  const bool absent = config.process.void_model == VoidModel::absent;
  list.add(std::string("void ") + (absent ? "quiet" : "absent"),
           [absent](Config& its) { its.process.void_model = absent ? VoidModel::quiet : VoidModel::absent; });
  return std::move(list.variations);
}

template <int Dim>
std::array<Variation, 2> variations_of_passes(const Setup<Dim>& setup, double per_bead) {
  const bool finer = per_bead < 1.0 && obstacle_of_finer_grid(setup).empty();
  std::array<Variation, 2> result;
  result[0].name = "simulated layers";
  result[0].change = [=](Config& its) {
    if (finer) refine_once(its);
  };
  result[1].name = "real layers";
  result[1].change = [=](Config& its) {
    if (finer) refine_once(its);
    cut_into_real_layers(its);
  };
  for (Variation& variation : result) variation.finer = finer;
  result[1].layers_times = setup.config.layers.passes;
  return result;
}

template <int Dim>
std::string obstacle_of_finer_grid(const Setup<Dim>& setup) {
  const std::optional<bool>& asked_for = setup.config.output.finer_grid;
  if (asked_for) return *asked_for ? "" : "left out by output.finer_grid";
  RunSize size = setup.size;
  for (double* number : {&size.unknowns, &size.nodes, &size.part_elements}) *number *= 1 << Dim;
  const double needed = memory_estimate(size, setup.config.solver.path, setup.groups.count(), setup.lanes);
  if (needed <= usable_memory * static_cast<double>(available_memory_bytes(setup.world()))) return "";
  return "it needs about " + std::to_string(std::llround(needed / 1e9) + 1) +
         " GB of memory; output.finer_grid true has it all the same";
}

FABSEQ_INSTANTIATE_FUNCTION(all_variations);
FABSEQ_INSTANTIATE_FUNCTION(variations_of_passes);
FABSEQ_INSTANTIATE_FUNCTION(obstacle_of_finer_grid);

}  // namespace fabseq
