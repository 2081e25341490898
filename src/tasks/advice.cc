// SPDX-License-Identifier: MIT
#include "tasks/advice.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/report/late_sets.h"
#include "fabseq/sequence/geodesic_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fabseq {

namespace {

/// The figures of docs/how-to/choose-what-to-optimize.md.
constexpr double least_elements_per_layer = 2.5;
constexpr double most_vacant_layers = 0.2, least_vacant_layers = -0.02;
/// Least share of the iterations that belongs to the last sharpness.
constexpr double share_of_last_beta = 0.2;
/// Share of the largest cross-section along the plate.
constexpr double least_foot = 0.05;

/// How N times the target goes with what there is to build.
template <int Dim>
void add_advice_on_count(const Setup<Dim>& setup, double geodesic_height, std::vector<std::string>& result) {
  const auto& target = setup.config.layers.target;
  if (!target || setup.config.layers.multi_planar) return;
  const int count = setup.layers->count();
  const double height = setup.config.layers.height_of(count), surplus = height / geodesic_height - 1.0;
  if (surplus < least_vacant_layers)
    result.push_back(formatted(
        "/layers/count: %d layers of %g reach %g of the geodesic height %.6g: no sequence satisfies the "
        "thickness constraint",
        count, target->value, height, geodesic_height));
  if (surplus > most_vacant_layers)
    result.push_back(
        formatted("/layers/count: %d layers of %g are %.0f %% more than the geodesic height %.6g: the "
                  "last layers stay empty",
                  count, target->value, 100.0 * surplus, geodesic_height));
}

/// Whether the sharpness reaches its last value early enough.
template <int Dim>
void add_advice_on_sharpness(const Setup<Dim>& setup, std::vector<std::string>& result) {
  const ProjectionSettings& projection = setup.config.projection;
  const LayerTraits& traits = setup.layers->traits();
  if (projection.binary || projection.factor <= 1.0) return;
  const double steps =
      std::ceil(std::log(traits.last_beta / traits.first_beta) / std::log(projection.factor));
  const int iterations = setup.config.optimizer.max_iterations;
  if (steps * projection.interval > (1.0 - share_of_last_beta) * iterations)
    result.push_back(
        formatted("/projection/interval: the sharpness grows until iteration %.0f of %d: take a shorter "
                  "interval or more iterations",
                  steps * projection.interval, iterations));
}

/// Part elements in the layer of elements of the grid, along the plate, that has most of them. Collective.
template <int Dim>
std::int64_t largest_cross_section(const Setup<Dim>& setup) {
  const int axis = setup.config.plate.axis;
  std::vector<std::int64_t> counts(static_cast<std::size_t>(setup.grid.domain().elements[axis]));
  for (const int element : setup.part.elements())
    ++counts[static_cast<std::size_t>(setup.grid.owned_elements().index(element)[axis])];
  sum_in_place(setup.grid.comm(), counts);
  return *std::max_element(counts.begin(), counts.end());
}

/// Whether the part stands on next to nothing.
template <int Dim>
void add_advice_on_foot(const Setup<Dim>& setup, std::vector<std::string>& result) {
  if (setup.part.substrate().count() > 0) return;
  const auto foot = setup.part.plate_contact(), largest = largest_cross_section(setup);
  const double share = static_cast<double>(foot) / static_cast<double>(largest);
  if (share < least_foot)
    result.push_back(formatted(
        "/build_plate: the part stands on %lld elements, %.2g %% of its largest cross-section along "
        "the plate: turn it, cut it flat (domain.origin), or give it a foot",
        static_cast<long long>(foot), 100.0 * share));
}

/// Whether a measured set lies where the part ends, by layers at equal distances along the part, which
/// sub-parts and material that follows the displaced part have little to do with.
template <int Dim>
void add_advice_on_late_sets(const Setup<Dim>& setup, std::span<const double> distance,
                             double geodesic_height, std::vector<std::string>& result) {
  const bool is_nominal = setup.config.process.deposition == DepositionModel::nominal;
  if (!is_nominal || setup.config.layers.multi_planar) return;
  const double layers = setup.layers->count();
  std::vector<double> layer_index(distance.begin(), distance.end());
  for (double& layer : layer_index)
    layer = std::min(layers, 1.0 + std::floor(layers * layer / geodesic_height));
  for (const LateSet& set : late_sets(setup.part, setup.node_sets, setup.config.objective, layer_index))
    result.push_back("/objective: in layers at equal distances from the plate " + set.words());
}

}  // namespace

template <int Dim>
double elements_per_layer(const Setup<Dim>& setup, double geodesic_height) {
  const auto& target = setup.config.layers.target;
  const double thickness = target ? target->value : geodesic_height / setup.layers->count();
  return thickness / setup.grid.largest_spacing();
}

template <int Dim>
double elements_per_bead(const Setup<Dim>& setup) {
  const double height = geodesic_height(setup.part, geodesic_distance(setup.part));
  return elements_per_layer(setup, height) / setup.config.layers.passes;
}

template <int Dim>
std::vector<std::string> advice(const Setup<Dim>& setup, std::span<const double> distance,
                                double geodesic_height) {
  std::vector<std::string> result;
  const double elements = elements_per_layer(setup, geodesic_height);
  if (elements < least_elements_per_layer)
    result.push_back(formatted("/layers: layers of %.2g elements become ragged, needs %g or more, better 4",
                               elements, least_elements_per_layer));
  add_advice_on_count(setup, geodesic_height, result);
  add_advice_on_sharpness(setup, result);
  add_advice_on_foot(setup, result);
  add_advice_on_late_sets(setup, distance, geodesic_height, result);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(elements_per_layer);
FABSEQ_INSTANTIATE_FUNCTION(elements_per_bead);
FABSEQ_INSTANTIATE_FUNCTION(advice);

}  // namespace fabseq
