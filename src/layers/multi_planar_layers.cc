// SPDX-License-Identifier: MIT
#include "layers/multi_planar_layers.h"

#include "fabseq/base/mpi.h"
#include "fabseq/layers/smooth_step.h"
#include "layers/print_direction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

/// Elements on a timestamp, or on the face between two slabs, belong to the earlier.
constexpr double tolerance = 1e-12;

/// First layer of a sub-part, and one behind its last.
std::pair<std::ptrdiff_t, std::ptrdiff_t> layers_of(const SubParts& sub_parts, int number) {
  const auto range = std::equal_range(sub_parts.of_layer.begin(), sub_parts.of_layer.end(), number);
  return {range.first - sub_parts.of_layer.begin(), range.second - sub_parts.of_layer.begin()};
}

}  // namespace

double NegligibleLayers::density(int slabs) const { return std::pow(load / slabs, 1.0 / exponent); }

template <int Dim>
MultiPlanarLayers<Dim>::MultiPlanarLayers(const Part<Dim>& part, const MultiPlanarSettings& settings,
                                          std::span<const double> angles, bool binary,
                                          const NegligibleLayers& negligible)
    : part_(part),
      settings_(settings),
      angles_(angles.begin(), angles.end()),
      binary_(binary),
      negligible_(negligible) {
  for (int i = 0; i < settings.subparts; ++i) {
    const auto direction = print_direction<Dim>(&angles_[static_cast<std::size_t>(i) * angle_count<Dim>]);
    directions_.insert(directions_.end(), direction.begin(), direction.end());
  }
  const auto& corner = part.grid().domain().origin;
  for (const int element : part.elements()) {
    Point<Dim> center = part.grid().element_center(part.grid().owned_elements().index(element));
    for (int axis = 0; axis < Dim; ++axis)
      center[axis] -= settings.origin.empty() ? corner[axis] : settings.origin[axis];
    centers_.insert(centers_.end(), center.begin(), center.end());
  }
}

template <int Dim>
std::vector<double> MultiPlanarLayers<Dim>::built_until(std::span<const double> time, int boundary) const {
  std::vector<double> result(time.size(), boundary == 0 ? 0.0 : 1.0);
  if (boundary == 0 || boundary == settings_.subparts) return result;
  const double timestamp = settings_.timestamps[boundary - 1];
  if (binary_) {
    for (std::size_t e = 0; e < time.size(); ++e) result[e] = time[e] <= timestamp + tolerance ? 1.0 : 0.0;
    return result;
  }
  const double sharpness = settings_.time_sharpness;
  for (std::size_t e = 0; e < time.size(); ++e)
    result[e] = Logistic::value(sharpness * (timestamp - time[e]));
  return result;
}

template <int Dim>
void MultiPlanarLayers<Dim>::add_step_derivative(std::span<const double> time, int boundary, double factor,
                                                 std::span<const double> weight,
                                                 std::span<double> d_time) const {
  if (boundary == 0 || boundary == settings_.subparts) return;
  const double timestamp = settings_.timestamps[boundary - 1], sharpness = settings_.time_sharpness;
  for (std::size_t e = 0; e < time.size(); ++e)
    d_time[e] += factor * (-sharpness * Logistic::derivative(sharpness * (timestamp - time[e]))) * weight[e];
}

template <int Dim>
std::vector<double> MultiPlanarLayers<Dim>::heights(int sub_part) const {
  const double* direction = &directions_[static_cast<std::size_t>(sub_part) * Dim];
  std::vector<double> result(centers_.size() / Dim, 0.0);
  for (std::size_t e = 0; e < result.size(); ++e)
    for (int axis = 0; axis < Dim; ++axis) result[e] += centers_[e * Dim + axis] * direction[axis];
  return result;
}

/// Slab j holds (j - 1) w < S <= j w.
template <int Dim>
int MultiPlanarLayers<Dim>::sharp_slab(double height) const {
  return static_cast<int>(std::ceil(height / settings_.slab_thickness() - tolerance));
}

template <int Dim>
void MultiPlanarLayers<Dim>::set_slab(std::span<const double> height, int slab,
                                      std::span<double> values) const {
  if (binary_) {
    for (std::size_t e = 0; e < height.size(); ++e) values[e] = sharp_slab(height[e]) == slab ? 1.0 : 0.0;
    return;
  }
  const SlabStep step(slab, settings_.slab_thickness(), settings_.slab_sharpness);
  for (std::size_t e = 0; e < height.size(); ++e) values[e] = step.value(height[e]);
}

/// Slabs go from floor(min S / w) to ceil(max S / w) + 1 over all ranks.
template <int Dim>
void MultiPlanarLayers<Dim>::find_slabs(const std::vector<std::vector<double>>& height,
                                        SubParts& sub_parts) const {
  std::vector<double> extremes;  // -min and max of each sub-part
  for (const auto& of_sub_part : height) {
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const double s : of_sub_part) {
      lowest = std::min(lowest, s);
      highest = std::max(highest, s);
    }
    extremes.insert(extremes.end(), {-lowest, highest});
  }
  max_in_place(part_.grid().comm(), extremes);
  for (std::size_t i = 0; i < height.size(); ++i) {
    sub_parts.first_slab.push_back(
        static_cast<int>(std::floor(-extremes[2 * i] / settings_.slab_thickness())));
    sub_parts.last_slab.push_back(
        static_cast<int>(std::ceil(extremes[2 * i + 1] / settings_.slab_thickness())) + 1);
  }
}

/// One number per slab of each sub-part, over all ranks. An element is in two or three slabs.
template <int Dim>
std::vector<std::vector<double>> MultiPlanarLayers<Dim>::largest_densities(
    const std::vector<std::vector<double>>& height, const SubParts& sub_parts) const {
  const double reach = SlabStep::reach(settings_.slab_sharpness);
  std::vector<std::vector<double>> result;
  for (int i = 0; i < settings_.subparts; ++i) {
    const int first = sub_parts.first_slab[i], last = sub_parts.last_slab[i];
    std::vector<double>& largest = result.emplace_back(last - first + 1, 0.0);
    const std::vector<double>& density = sub_parts.density[i];
    for (std::size_t e = 0; e < density.size(); ++e) {
      const double place = height[i][e] / settings_.slab_thickness() + 0.5;  // j of the slab with this middle
      const int low = binary_ ? sharp_slab(height[i][e]) : static_cast<int>(std::ceil(place - reach));
      const int high = binary_ ? low : static_cast<int>(std::floor(place + reach));
      for (int j = std::max(low, first); j <= std::min(high, last); ++j) {
        double slab = 0.0;
        set_slab({&height[i][e], 1}, j, {&slab, 1});
        largest[j - first] = std::max(largest[j - first], density[e] * slab);
      }
    }
    max_in_place(part_.grid().comm(), largest);
  }
  return result;
}

template <int Dim>
void MultiPlanarLayers<Dim>::set_densities(std::span<const double> time, LayerDensities& densities) const {
  densities.time_points.clear();
  SubParts& sub_parts = densities.sub_parts;
  sub_parts = {settings_.timestamps, directions_, {}, {}, {}, {}, {}};
  const std::vector<double>& part_density = part_.part_density();
  std::vector<std::vector<double>> height, before;
  for (int i = 0; i < settings_.subparts; ++i) {
    height.push_back(heights(i));
    before.push_back(built_until(time, i));
    sub_parts.density.push_back(built_until(time, i + 1));
    std::vector<double>& density = sub_parts.density.back();
    for (std::size_t e = 0; e < density.size(); ++e)
      density[e] = part_density[e] * std::max(density[e] - before[i][e], 0.0);
  }
  find_slabs(height, sub_parts);
  const auto largest = largest_densities(height, sub_parts);
  int slabs = 0;
  for (const auto& of_sub_part : largest) slabs += static_cast<int>(of_sub_part.size());
  const double negligible = negligible_.density(slabs);

  std::size_t count = 0;
  std::vector<double> slab(time.size()), built(time.size());
  for (int i = 0; i < settings_.subparts; ++i) {
    std::fill(built.begin(), built.end(), 0.0);
    for (int j = sub_parts.first_slab[i]; j <= sub_parts.last_slab[i]; ++j) {
      set_slab(height[i], j, slab);
      for (std::size_t e = 0; e < slab.size(); ++e) built[e] += slab[e];
      if (!(largest[i][j - sub_parts.first_slab[i]] > negligible)) continue;
      sub_parts.of_layer.push_back(i);
      sub_parts.slab.push_back(j);
      densities.stage.resize(std::max(densities.stage.size(), ++count));
      densities.layer.resize(densities.stage.size());
      auto& stage = densities.stage[count - 1];
      auto& layer = densities.layer[count - 1];
      stage.resize(time.size());
      layer.resize(time.size());
      const double* density = sub_parts.density[i].data();
      for (std::size_t e = 0; e < time.size(); ++e) {
        stage[e] = part_density[e] * before[i][e] + density[e] * built[e];
        layer[e] = density[e] * slab[e];
      }
    }
  }
  densities.stage.resize(count);
  densities.layer.resize(count);
}

/// Computes, with the sum over the stages from j on, G_j = sum_{k >= j} dJ/d(rho_stage,k), and g_j = G_j +
/// dJ/d(drho_j), dJ/dE_i = sum_j rho E_ij g_j and dJ/dE_ij = rho E_i g_j, also for slabs that are no layers.
template <int Dim>
typename MultiPlanarLayers<Dim>::FieldDerivatives MultiPlanarLayers<Dim>::derivatives_of_fields(
    std::span<const double> height, int sub_part, const LayerDensities& densities,
    const DensityDerivatives& derivatives) const {
  const SubParts& sub_parts = densities.sub_parts;
  const std::vector<double>& part_density = part_.part_density();
  const double* density = sub_parts.density[sub_part].data();
  const std::size_t elements = height.size();
  FieldDerivatives result{std::vector<double>(elements, 0.0), std::vector<double>(elements, 0.0),
                          std::vector<double>(elements, 0.0)};
  std::vector<double> later(elements, 0.0), both(elements);
  const auto add = [](const std::vector<double>& derivative, std::vector<double>& sum) {
    for (std::size_t e = 0; e < derivative.size(); ++e) sum[e] += derivative[e];
  };
  auto [first, behind] = layers_of(sub_parts, sub_part);
  for (int j = sub_parts.last_slab[sub_part]; j >= sub_parts.first_slab[sub_part]; --j) {
    const bool is_layer = behind > first && sub_parts.slab[behind - 1] == j;
    if (is_layer) add(derivatives.stage[--behind], later);
    both = later;
    if (is_layer) add(derivatives.layer[behind], both);
    const SlabStep step(j, settings_.slab_thickness(), settings_.slab_sharpness);
    for (std::size_t e = 0; e < elements; ++e) {
      result.sub_part[e] += part_density[e] * step.value(height[e]) * both[e];
      result.height[e] += density[e] * step.derivative(height[e]) * both[e];
    }
  }
  for (std::size_t e = 0; e < elements; ++e) result.before[e] = part_density[e] * later[e];
  return result;
}

template <int Dim>
void MultiPlanarLayers<Dim>::pull_back(std::span<const double> time, const LayerDensities& densities,
                                       const DensityDerivatives& derivatives, std::span<double> d_time,
                                       std::span<double> d_variables) const {
  std::vector<double> d_directions = derivatives.directions;
  d_directions.resize(directions_.size(), 0.0);
  const auto has_entries = [](const std::vector<double>& entries) { return !entries.empty(); };
  for (int i = 0; i < settings_.subparts && !binary_; ++i) {
    const auto [first, behind] = layers_of(densities.sub_parts, i);
    const auto any_of_layers = [&, first = first, behind = behind](const auto& list) {
      return std::any_of(list.begin() + first, list.begin() + behind, has_entries);
    };
    FieldDerivatives fields;
    if (any_of_layers(derivatives.stage) || any_of_layers(derivatives.layer)) {
      fields = derivatives_of_fields(heights(i), i, densities, derivatives);
      add_step_derivative(time, i, 1.0, fields.before, d_time);
      for (std::size_t e = 0; e < fields.height.size(); ++e)
        for (int axis = 0; axis < Dim; ++axis)
          d_directions[static_cast<std::size_t>(i) * Dim + axis] +=
              fields.height[e] * centers_[e * Dim + axis];
    }
    if (static_cast<std::size_t>(i) < derivatives.sub_part.size() && has_entries(derivatives.sub_part[i])) {
      fields.sub_part.resize(time.size(), 0.0);
      for (std::size_t e = 0; e < time.size(); ++e)
        fields.sub_part[e] += part_.part_density()[e] * derivatives.sub_part[i][e];
    }
    if (fields.sub_part.empty()) continue;
    add_step_derivative(time, i + 1, 1.0, fields.sub_part, d_time);
    add_step_derivative(time, i, -1.0, fields.sub_part, d_time);
  }
  for (std::size_t i = 0; i * angle_count<Dim> < d_variables.size(); ++i)
    add_angle_derivatives<Dim>(&angles_[i * angle_count<Dim>], &d_directions[i * Dim],
                               &d_variables[i * angle_count<Dim>]);
}

template <int Dim>
std::vector<double> MultiPlanarLayers<Dim>::layer_index(std::span<const double> time,
                                                        const LayerDensities& densities) const {
  const SubParts& sub_parts = densities.sub_parts;
  std::vector<std::vector<double>> height;
  for (int i = 0; i < settings_.subparts; ++i) height.push_back(heights(i));
  std::vector<double> result(time.size());
  for (std::size_t e = 0; e < time.size(); ++e) {
    const auto& timestamps = settings_.timestamps;
    const auto sub_part = static_cast<int>(
        std::lower_bound(timestamps.begin(), timestamps.end(), time[e] - tolerance) - timestamps.begin());
    const auto [first, behind] = layers_of(sub_parts, sub_part);
    const auto begin = sub_parts.slab.begin();
    const auto place =
        std::lower_bound(begin + first, begin + behind, sharp_slab(height[sub_part][e])) - begin;
    result[e] = static_cast<double>(std::min<std::size_t>(place + 1, sub_parts.slab.size()));
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(MultiPlanarLayers);

}  // namespace fabseq
