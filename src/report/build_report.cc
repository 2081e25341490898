// SPDX-License-Identifier: MIT
#include "fabseq/report/build_report.h"

#include "fabseq/machine/footing.h"
#include "fabseq/machine/local_thickness.h"
#include "fabseq/report/build_class.h"

#include <utility>

namespace fabseq {

namespace {

/// Finds the places of what fails by checks that the report has. Collective.
template <int Dim>
void add_places(const MeasuredSequence<Dim>& sequence, BuildReport& report) {
  const Grid<Dim>& grid = sequence.part().grid();
  const ModelSettings& settings = sequence.settings();
  const double width = settings.tool.bead_width;
  FaultyPlaces places;
  places.bead = {width_of_bead(grid, width),
                 settings.layers.target ? settings.layers.target->value : grid.largest_spacing()};
  places.part_volume = sequence.part().volume();
  std::vector<double> fault(sequence.layer_index.size(), 0.0);
  std::vector<Places> kinds;
  for (const Fault kind : all_faults) {
    const auto marks = fault_marks(report.fields, settings, kind);
    if (!marks) continue;
    kinds.push_back(find_places<Dim>(sequence.part(), kind, *marks, *report.fields.find(name_of(kind)),
                                     {sequence.direction, sequence.layer_index, width}));
    for (std::size_t e = 0; e < marks->size(); ++e)
      if ((*marks)[e] > 0.0 && fault[e] == 0.0) fault[e] = static_cast<double>(kind);
  }
  static_cast<Places&>(places) = merged(std::move(kinds));
  for (Place& place : places.largest)
    if (place.fault == Fault::local_thickness)
      place.form = place.worst < settings.layers.target->value ? PlaceForm::thin : PlaceForm::thick;
  report.numbers.places = std::move(places);
  report.fields.add({"fault", std::move(fault)});
}

template <int Dim>
MeasuredSequence<Dim> last_run(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                               const StageResults<Dim>& state) {
  return {.model = model,
          .time = *state.time,
          .layers = *state.densities,
          .layer_index = pipeline.last_layer_index(),
          .pipeline = &pipeline,
          .state = &state};
}

template <int Dim>
BuildReport checked(MeasuredSequence<Dim>& sequence, bool with_places) {
  BuildReport report;
  sequence.find_direction();
  measure_findings(sequence, {MeasuredIn::checks}, report);
  if (with_places) add_places(sequence, report);
  return report;
}

}  // namespace

std::optional<std::array<double, 2>> allowed_thickness(const ModelSettings& settings) {
  if (!settings.layers.target) return std::nullopt;
  const double target = settings.layers.target->value;
  return std::array{settings.tool.thickness[0] * target, settings.tool.thickness[1] * target};
}

std::optional<std::vector<double>> fault_marks(const BuildFields& fields, const ModelSettings& settings,
                                               Fault fault) {
  const std::vector<double>* figures = fields.find(name_of(fault));
  if (figures == nullptr) return std::nullopt;
  std::vector<double> marks = *figures;
  if (fault == Fault::tilt)
    for (double& angle : marks) angle -= settings.tool.max_tilt;
  if (fault != Fault::local_thickness) return marks;
  const auto allowed = allowed_thickness(settings);
  return allowed ? std::optional(beyond_range(marks, *allowed)) : std::nullopt;
}

template <int Dim>
BuildReport check_layers(const Model<Dim>& model, const PseudoTime<Dim>& time, const LayerDensities& layers,
                         const std::vector<double>& layer_index, bool with_places) {
  MeasuredSequence<Dim> sequence{.model = model, .time = time, .layers = layers, .layer_index = layer_index};
  return checked(sequence, with_places);
}

template <int Dim>
BuildReport check_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                        const StageResults<Dim>& state) {
  MeasuredSequence<Dim> sequence = last_run(model, pipeline, state);
  return checked(sequence, /*with_places=*/false);
}

template <int Dim>
BuildReport check_places(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state) {
  MeasuredSequence<Dim> sequence = last_run(model, pipeline, state);
  return checked(sequence, /*with_places=*/true);
}

template <int Dim>
BuildReport report_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state, int used_layers) {
  MeasuredSequence<Dim> sequence = last_run(model, pipeline, state);
  sequence.with_shape = true;
  sequence.used_layers = used_layers;
  BuildReport report = checked(sequence, /*with_places=*/true);
  measure_findings(sequence, {MeasuredIn::evaluations, MeasuredIn::reports}, report);
  return report;
}

template <int Dim>
BuildReport report_evaluation(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                              const StageResults<Dim>& state) {
  BuildReport report;
  measure_findings(last_run(model, pipeline, state), {MeasuredIn::evaluations}, report);
  return report;
}

FABSEQ_INSTANTIATE_FUNCTION(check_layers);
FABSEQ_INSTANTIATE_FUNCTION(check_build);
FABSEQ_INSTANTIATE_FUNCTION(check_places);
FABSEQ_INSTANTIATE_FUNCTION(report_build);
FABSEQ_INSTANTIATE_FUNCTION(report_evaluation);

}  // namespace fabseq
