// SPDX-License-Identifier: MIT
#include "fabseq/run/build_report.h"

#include "fabseq/base/mpi.h"
#include "fabseq/machine/build_direction.h"
#include "fabseq/process/residual_stress.h"

namespace fabseq {

namespace {

std::optional<std::array<double, 2>> allowed_thickness(const ModelSettings& settings) {
  if (!settings.layers.target) return std::nullopt;
  const double target = settings.layers.target->value;
  return std::array{settings.tool.thickness[0] * target, settings.tool.thickness[1] * target};
}

/// Wire and time: welding at the deposition rate, and a pause after each layer.
void estimate_time(const ModelSettings& settings, double volume, int layers, BuildNumbers& numbers) {
  constexpr double seconds_per_hour = 3600.0;
  if (!settings.material.mass_density) return;
  numbers.wire = *settings.material.mass_density * volume;
  if (!settings.process.deposition_rate) return;
  numbers.hours =
      *numbers.wire / *settings.process.deposition_rate + layers * settings.process.dwell / seconds_per_hour;
}

/// Vectors of the part elements on all owned elements; none if they are defined on no rank.
template <int Dim>
std::optional<std::vector<double>> expand_vectors(const Part<Dim>& part, std::span<const double> vectors) {
  if (!any(part.grid().comm(), !vectors.empty())) return std::nullopt;
  std::vector<double> field(part.density().size() * Dim, 0.0);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    field[static_cast<std::size_t>(part.elements()[i / Dim]) * Dim + i % Dim] = vectors[i];
  return field;
}

}  // namespace

template <int Dim>
BuildReport report_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const PipelineState<Dim>& state, int used_layers) {
  const Part<Dim>& part = model.part;
  const ModelSettings& settings = model.settings;
  const std::vector<double> layer = pipeline.last_layer_index();
  const std::vector<double> direction = build_direction(state.time, state.layers, layer);
  const std::vector<double> thickness = local_thickness(state.time, state.layers, layer);
  const std::vector<double> hanging = hanging_elements<Dim>(part, direction, layer, settings.tool.bead_width);
  const HangingCount<Dim> count = count_hanging<Dim>(part, hanging, layer, state.layers.count());

  BuildReport report;
  BuildNumbers& numbers = report.numbers;
  numbers.local_thickness = thickness_range<Dim>(part, thickness, allowed_thickness(settings));
  numbers.hanging = count.elements;
  numbers.hanging_per_layer = count.per_layer;
  if (count.at) numbers.hanging_at.assign(count.at->begin(), count.at->end());
  estimate_time(settings, part.volume(), used_layers, numbers);
  if (const auto yield = settings.material.yield_stress) {
    const std::vector<double> stress = residual_stress(pipeline.process(), state.layers);
    numbers.stress = {stress_extremes(part, stress).von_mises, share_beyond(part, stress, *yield)};
  }
  report.fields.direction = expand_vectors<Dim>(part, direction);
  if (numbers.local_thickness) report.fields.local_thickness = part.expand(thickness);
  report.fields.hanging = part.expand(hanging);
  return report;
}

FABSEQ_INSTANTIATE_FUNCTION(report_build);

}  // namespace fabseq
