// SPDX-License-Identifier: MIT
#include "fabseq/report/build_report.h"

#include "fabseq/base/mpi.h"
#include "fabseq/machine/blocked.h"
#include "fabseq/machine/build_direction.h"
#include "fabseq/machine/hanging.h"
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/machine/meeting_fronts.h"
#include "fabseq/machine/time_gradient.h"
#include "fabseq/process/residual_stress.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

std::optional<std::array<double, 2>> allowed_thickness(const ModelSettings& settings) {
  if (!settings.layers.target) return std::nullopt;
  const double target = settings.layers.target->value;
  return std::array{settings.tool.thickness[0] * target, settings.tool.thickness[1] * target};
}

/// Wire and time: welding at the deposition rate, and a pause after each real layer.
void estimate_time(const ModelSettings& settings, double volume, int layers, BuildNumbers& numbers) {
  if (!settings.material.mass_density) return;
  numbers.wire = *settings.material.mass_density * volume;
  if (const auto clock = settings.clock()) numbers.hours = clock->hours(volume, layers);
}

/// What a machine would say of the binary layers of a pipeline's last run (docs/formulation.md 13.1).
template <int Dim>
class MachineChecks {
 public:
  MachineChecks(const Model<Dim>& model, const Pipeline<Dim>& pipeline, const PipelineState<Dim>& state)
      : part_(model.part),
        settings_(model.settings),
        state_(state),
        layer_(pipeline.last_layer_index()),
        gradient_(time_gradient(model.part, state.time, state.layers)),
        direction_(build_direction<Dim>(gradient_.values, state.layers, layer_)) {}

  /// Finds the places of what fails by checks that add_to() made. Collective.
  void add_places(BuildReport& report) const {
    const Grid<Dim>& grid = part_.grid();
    const double coarsest = grid.largest_spacing(), width = settings_.tool.bead_width;
    FaultyPlaces places;
    places.bead = {width > 0.0 ? width : 2.0 * coarsest,
                   settings_.layers.target ? settings_.layers.target->value : coarsest};
    places.part_volume = part_.volume();
    std::vector<double> fault(layer_.size(), 0.0);
    std::vector<Places> kinds;
    const auto add = [&](Fault kind, const std::vector<double>& marks, const std::vector<double>& figures) {
      kinds.push_back(find_places<Dim>(part_, kind, marks, figures, {direction_, layer_, width}));
      for (std::size_t e = 0; e < marks.size(); ++e)
        if (marks[e] > 0.0 && fault[e] == 0.0) fault[e] = static_cast<double>(kind);
    };
    const BuildFields& fields = report.fields;
    add(Fault::hanging, *fields.hanging, *fields.hanging);
    if (const auto allowed = allowed_thickness(settings_); allowed && fields.local_thickness)
      add(Fault::local_thickness, beyond_range(*fields.local_thickness, *allowed), *fields.local_thickness);
    if (fields.tilt) add(Fault::tilt, beyond_tilt(*fields.tilt), *fields.tilt);
    if (fields.blocked) add(Fault::blocked, *fields.blocked, *fields.blocked);
    static_cast<Places&>(places) = merged(std::move(kinds));
    for (Place& place : places.largest)
      if (place.fault == Fault::local_thickness)
        place.form = place.worst < settings_.layers.target->value ? PlaceForm::thin : PlaceForm::thick;
    report.numbers.places = std::move(places);
    report.fields.fault = std::move(fault);
  }

  /// Collective.
  void add_to(BuildReport& report) const {
    if (any(part_.grid().comm(), !direction_.empty())) report.fields.direction = direction_;
    report.numbers.gradient = gradient_.source;
    report.numbers.gradient_elsewhere = gradient_.share_elsewhere;
    add_torch(report);
    add_thickness(report);
    std::vector<double> hanging = hanging_elements<Dim>(part_, direction_, layer_, settings_.tool.bead_width);
    report.numbers.hanging = count(hanging, MarkedPlace::earliest);
    report.fields.hanging = std::move(hanging);
    const InteriorExtrema extrema = find_interior_extrema<Dim>(part_, state_.time.time);
    report.numbers.interior_minima = count(extrema.minima, MarkedPlace::earliest);
    report.numbers.interior_maxima = count(extrema.maxima, MarkedPlace::earliest);
  }

 private:
  MarkedElements count(std::span<const double> marks, MarkedPlace place) const {
    return count_marked<Dim>(part_, marks, layer_, state_.layers.count(), place);
  }

  std::vector<double> beyond_tilt(std::vector<double> tilt) const {
    for (double& angle : tilt) angle -= settings_.tool.max_tilt;
    return tilt;
  }

  void add_torch(BuildReport& report) const {
    const ToolSettings& tool = settings_.tool;
    const std::vector<double> axis = torch_axis<Dim>(part_, tool, direction_);
    if (!any(part_.grid().comm(), !axis.empty())) return;
    std::vector<double> tilt = torch_tilt<Dim>(part_, axis);
    const double largest =
        std::accumulate(tilt.begin(), tilt.end(), 0.0, [](double a, double b) { return std::max(a, b); });
    report.numbers.tilt = {max(part_.grid().comm(), largest), count(beyond_tilt(tilt), MarkedPlace::largest)};
    report.fields.tilt = std::move(tilt);
    if (tool.profile.empty()) return;
    std::vector<double> blocked = blocked_depth<Dim>(part_, Torch(tool), axis, layer_);
    report.numbers.blocked = count(blocked, MarkedPlace::largest);
    report.fields.blocked = std::move(blocked);
  }

  void add_thickness(BuildReport& report) const {
    std::vector<double> thickness =
        local_thickness<Dim>(state_.time.time, gradient_.values, state_.layers, layer_, part_.longest_edge());
    report.numbers.local_thickness = thickness_range<Dim>(
        part_, thickness, gradient_.values, meeting_fronts<Dim>(part_, state_.time.time, gradient_.values),
        allowed_thickness(settings_), layer_, state_.layers.count());
    if (report.numbers.local_thickness) report.fields.local_thickness = std::move(thickness);
    if (state_.layers.time_points.empty()) return;
    std::vector<double> late;
    for (const double time : state_.time.time)
      late.push_back(state_.layers.count() * (time - state_.layers.time_points.back()) - late_from);
    report.numbers.late = count(late, MarkedPlace::largest);
  }

  const Part<Dim>& part_;
  const ModelSettings& settings_;
  const PipelineState<Dim>& state_;
  std::vector<double> layer_;
  TimeGradient gradient_;
  std::vector<double> direction_;
};

}  // namespace

template <int Dim>
void add_build_fields(FieldSet<Dim>& fields, const Part<Dim>& part, const BuildFields& build,
                      const std::string& prefix) {
  const auto add = [&](const char* name, const std::optional<std::vector<double>>& values,
                       int components = 1) {
    if (values) fields.add_elements(prefix + name, *values, components, &part.elements());
  };
  add("build_direction", build.direction, Dim);
  add("blocked", build.blocked);
  add("tilt", build.tilt);
  add("local_thickness", build.local_thickness);
  add("hanging", build.hanging);
  add("fault", build.fault);
  add("von_mises", build.von_mises);
}

template <int Dim>
BuildReport check_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                        const PipelineState<Dim>& state) {
  BuildReport report;
  MachineChecks<Dim>(model, pipeline, state).add_to(report);
  return report;
}

template <int Dim>
BuildReport check_places(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const PipelineState<Dim>& state) {
  BuildReport report;
  const MachineChecks<Dim> checks(model, pipeline, state);
  checks.add_to(report);
  checks.add_places(report);
  return report;
}

template <int Dim>
BuildReport report_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const PipelineState<Dim>& state, int used_layers) {
  BuildReport report = check_places(model, pipeline, state);
  estimate_time(model.settings, model.part.volume(), used_layers, report.numbers);
  if (const auto yield = model.settings.material.yield_stress) {
    const std::vector<double> stress = residual_stress(pipeline.process(), state.layers);
    report.numbers.stress = {stress_extremes(model.part, stress).von_mises,
                             share_beyond(model.part, stress, *yield)};
    report.fields.von_mises = equivalent_stress(model.part, stress);
  }
  return report;
}

FABSEQ_INSTANTIATE_FUNCTION(add_build_fields);
FABSEQ_INSTANTIATE_FUNCTION(check_build);
FABSEQ_INSTANTIATE_FUNCTION(check_places);
FABSEQ_INSTANTIATE_FUNCTION(report_build);

}  // namespace fabseq
