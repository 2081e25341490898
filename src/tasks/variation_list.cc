// SPDX-License-Identifier: MIT
/// The changes of the sensitivity table.
#include "fabseq/base/formatted.h"
#include "tasks/variation.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// "+10 %", "-10 %"
std::string percent(double factor) { return formatted("%+.0f %%", 100.0 * (factor - 1.0)); }

struct List {
  const Json fixed;  ///< what each of them starts from
  std::vector<Variation> variations = {};

  Variation& add(const std::string& name) { return variations.emplace_back(Variation{name, fixed}); }
};

/// Components of a strain that is fixed; of one that turns with the layers, the factors of its axes.
void add_strains(List& list, const Config& config) {
  const bool turns = config.material.turning_strain.has_value();
  const std::vector<std::string> names = config.dimension() == 2
                                             ? std::vector<std::string>{"xx", "yy", "xy"}
                                             : std::vector<std::string>{"xx", "yy", "zz", "xy", "yz", "zx"};
  const Json& values = config.effective.at("material").at(turns ? "strain_scale" : "inherent_strain");
  for (std::size_t c = 0; c < values.size(); ++c)
    for (const double factor : {1.0 + size_of_change, 1.0 - size_of_change}) {
      const double value = values[c].get<double>();
      if (value == 0.0) continue;
      const std::string of = turns ? "strain, factor of axis " + names[c].substr(0, 1) : "strain " + names[c];
      Json& material = list.add(of + " " + percent(factor)).document["material"];
      material[turns ? "strain_scale" : "inherent_strain"][c] = factor * value;
    }
}

void add_poisson(List& list, const Config& config) {
  const double poisson = config.material.poisson;
  if (poisson == 0.0) return;
  for (const double factor : {1.0 + size_of_change, 1.0 - size_of_change}) {
    // A material may come near 0.5, at which it has no more room to give.
    const double value = std::min(factor * poisson, 0.5 * (poisson + 0.5));
    list.add(formatted("Poisson's ratio %.3g", value)).document["material"]["poisson"] = value;
  }
}

/// Of layers whose number follows from their thickness.
void add_thicknesses(List& list, double thickness, int baseline_layers) {
  const auto add = [&](const char* name, double factor) {
    Json& document = list.add(formatted(name, factor * thickness)).document;
    document["layers"]["thickness"] = factor * thickness;
    document["baseline"]["layers"] = std::max(1, static_cast<int>(std::lround(baseline_layers / factor)));
  };
  add("layers 10 %% thicker: %.4g", 1.0 + size_of_change);
  add("layers 10 %% thinner: %.4g", 1.0 - size_of_change);
  add("layers half as thick: %.4g", 0.5);
}

void add_layers(List& list, int layers, int baseline_layers) {
  const auto add = [&](const std::string& name, int count, int baseline) {
    Json& document = list.add(name + ": " + std::to_string(count)).document;
    document["layers"]["count"] = count;
    document["baseline"]["layers"] = std::max(1, baseline);
  };
  if (layers > 1) add("one layer less", layers - 1, baseline_layers - 1);
  add("one layer more", layers + 1, baseline_layers + 1);
  add("layers doubled", 2 * layers, 2 * baseline_layers);
}

void add_finer_grid(List& list) {
  Variation& variation = list.add("grid twice as fine");
  variation.finer = true;
  for (Json& elements : variation.document["domain"]["elements"]) elements = 2 * elements.get<int>();
  // Stairs may leave crumbs that the coarse grid does not have.
  variation.document["part"]["keep"] = "connected";
}

template <int Dim>
Json fixed_document(const Setup<Dim>& setup) {
  Json document = setup.document();
  document["solver"]["layer_groups"] = setup.groups.count();
  // Sharpness is no matter of the config here; its relations to the number of layers shall refuse nothing.
  document.erase("projection");
  document["constraints"] = Json::array();
  return document;
}

}  // namespace

template <int Dim>
std::vector<Variation> all_variations(const Setup<Dim>& setup) {
  const Config& config = setup.config;
  List list{fixed_document(setup)};
  list.add("unchanged");
  add_strains(list, config);
  add_poisson(list, config);
  if (const Json* thickness = find_member(list.fixed.at("layers"), "thickness"))
    add_thicknesses(list, thickness->get<double>(), setup.baseline->count());
  else
    add_layers(list, setup.layers->count(), setup.baseline->count());
  list.add("layers smooth, as optimized").smooth = true;
  add_finer_grid(list);
  const bool absent = config.process.void_model == VoidModel::absent;
  const char* other_void = absent ? "quiet" : "absent";
  list.add(std::string("void ") + other_void).document["process"]["void"] = other_void;
  return std::move(list.variations);
}

FABSEQ_INSTANTIATE_FUNCTION(all_variations);

}  // namespace fabseq
