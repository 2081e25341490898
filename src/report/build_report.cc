// SPDX-License-Identifier: MIT
#include "fabseq/report/build_report.h"

#include "fabseq/base/mpi.h"
#include "fabseq/machine/blocked.h"
#include "fabseq/machine/build_direction.h"
#include "fabseq/machine/footing.h"
#include "fabseq/machine/hanging.h"
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/machine/meeting_fronts.h"
#include "fabseq/machine/time_gradient.h"
#include "fabseq/process/residual_stress.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace fabseq {

namespace {

std::optional<std::array<double, 2>> allowed_thickness(const ModelSettings& settings) {
  if (!settings.layers.target) return std::nullopt;
  const double target = settings.layers.target->value;
  return std::array{settings.tool.thickness[0] * target, settings.tool.thickness[1] * target};
}

std::vector<double> beyond_tilt(std::vector<double> tilt, const ModelSettings& settings) {
  for (double& angle : tilt) angle -= settings.tool.max_tilt;
  return tilt;
}

/// What is told of the elements that fail a check, Place::worst.
const std::optional<std::vector<double>>& figures(const BuildFields& fields, Fault fault) {
  switch (fault) {
    case Fault::hanging:
      return fields.hanging;
    case Fault::local_thickness:
      return fields.local_thickness;
    case Fault::tilt:
      return fields.tilt;
    default:
      return fields.blocked;
  }
}

/// Wire and time: welding at the deposition rate, and a pause after each real layer.
void estimate_time(const ModelSettings& settings, double volume, int layers, BuildNumbers& numbers) {
  if (!settings.material.mass_density) return;
  numbers.wire = *settings.material.mass_density * volume;
  if (const auto clock = settings.clock()) numbers.hours = clock->hours(volume, layers);
}

/// What a machine would say of binary layers (docs/formulation.md 13.1).
template <int Dim>
class MachineChecks {
 public:
  MachineChecks(const Model<Dim>& model, const PseudoTime<Dim>& time, const LayerDensities& layers,
                std::vector<double> layer_index)
      : part_(model.part),
        settings_(model.settings),
        time_(time),
        layers_(layers),
        layer_(std::move(layer_index)),
        gradient_(time_gradient(model.part, time, layers)),
        direction_(build_direction<Dim>(gradient_.values, layers, layer_)) {}

  /// Finds the places of what fails by checks that add_to() made. Collective.
  void add_places(BuildReport& report) const {
    const Grid<Dim>& grid = part_.grid();
    const double width = settings_.tool.bead_width;
    FaultyPlaces places;
    places.bead = {width_of_bead(grid, width),
                   settings_.layers.target ? settings_.layers.target->value : grid.largest_spacing()};
    places.part_volume = part_.volume();
    std::vector<double> fault(layer_.size(), 0.0);
    std::vector<Places> kinds;
    for (const Fault kind : all_faults) {
      const auto marks = fault_marks(report.fields, settings_, kind);
      if (!marks) continue;
      kinds.push_back(
          find_places<Dim>(part_, kind, *marks, *figures(report.fields, kind), {direction_, layer_, width}));
      for (std::size_t e = 0; e < marks->size(); ++e)
        if ((*marks)[e] > 0.0 && fault[e] == 0.0) fault[e] = static_cast<double>(kind);
    }
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
    const InteriorExtrema extrema = find_interior_extrema<Dim>(part_, time_.time);
    report.numbers.interior_minima = count(extrema.minima, MarkedPlace::earliest);
    report.numbers.interior_maxima = count(extrema.maxima, MarkedPlace::earliest);
  }

 private:
  MarkedElements count(std::span<const double> marks, MarkedPlace place) const {
    return count_marked<Dim>(part_, marks, layer_, layers_.count(), place);
  }

  void add_torch(BuildReport& report) const {
    const ToolSettings& tool = settings_.tool;
    const std::vector<double> axis = torch_axis<Dim>(part_, tool, direction_);
    if (!any(part_.grid().comm(), !axis.empty())) return;
    std::vector<double> tilt = torch_tilt<Dim>(part_, axis);
    const double largest =
        std::accumulate(tilt.begin(), tilt.end(), 0.0, [](double a, double b) { return std::max(a, b); });
    report.numbers.tilt = {max(part_.grid().comm(), largest),
                           count(beyond_tilt(tilt, settings_), MarkedPlace::largest)};
    report.fields.tilt = std::move(tilt);
    if (tool.profile.empty()) return;
    std::vector<double> blocked = blocked_depth<Dim>(part_, Torch(tool), axis, layer_);
    report.numbers.blocked = count(blocked, MarkedPlace::largest);
    report.fields.blocked = std::move(blocked);
  }

  void add_thickness(BuildReport& report) const {
    std::vector<double> thickness =
        local_thickness<Dim>(time_.time, gradient_.values, layers_, layer_, part_.longest_edge());
    report.numbers.local_thickness = thickness_range<Dim>(
        part_, thickness, gradient_.values, meeting_fronts<Dim>(part_, time_.time, gradient_.values),
        allowed_thickness(settings_), layer_, layers_.count());
    if (report.numbers.local_thickness) report.fields.local_thickness = std::move(thickness);
    if (layers_.time_points.empty()) return;
    std::vector<double> late;
    for (const double time : time_.time)
      late.push_back(layers_.count() * (time - layers_.time_points.back()) - late_from);
    report.numbers.late = count(late, MarkedPlace::largest);
  }

  const Part<Dim>& part_;
  const ModelSettings& settings_;
  const PseudoTime<Dim>& time_;
  const LayerDensities& layers_;
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

std::optional<std::vector<double>> fault_marks(const BuildFields& fields, const ModelSettings& settings,
                                               Fault fault) {
  std::optional<std::vector<double>> marks = figures(fields, fault);
  if (!marks) return marks;
  if (fault == Fault::tilt) return beyond_tilt(*std::move(marks), settings);
  if (fault != Fault::local_thickness) return marks;
  const auto allowed = allowed_thickness(settings);
  return allowed ? std::optional(beyond_range(*marks, *allowed)) : std::nullopt;
}

template <int Dim>
BuildReport check_layers(const Model<Dim>& model, const PseudoTime<Dim>& time, const LayerDensities& layers,
                         std::vector<double> layer_index, bool with_places) {
  BuildReport report;
  const MachineChecks<Dim> checks(model, time, layers, std::move(layer_index));
  checks.add_to(report);
  if (with_places) checks.add_places(report);
  return report;
}

template <int Dim>
BuildReport check_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                        const StageResults<Dim>& state) {
  return check_layers(model, *state.time, *state.densities, pipeline.last_layer_index(),
                      /*with_places=*/false);
}

template <int Dim>
BuildReport check_places(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state) {
  return check_layers(model, *state.time, *state.densities, pipeline.last_layer_index(),
                      /*with_places=*/true);
}

template <int Dim>
BuildReport report_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state, int used_layers) {
  BuildReport report = check_places(model, pipeline, state);
  report.numbers.stock = model.part.share_of_stock();
  estimate_time(model.settings, model.part.volume(), used_layers, report.numbers);
  if (const auto yield = model.settings.material.yield_stress) {
    const std::vector<double> stress = residual_stress(pipeline.process(), *state.densities);
    report.numbers.stress = {stress_extremes(model.part, stress).von_mises,
                             share_beyond(model.part, stress, *yield)};
    report.fields.von_mises = equivalent_stress(model.part, stress);
  }
  return report;
}

FABSEQ_INSTANTIATE_FUNCTION(add_build_fields);
FABSEQ_INSTANTIATE_FUNCTION(check_layers);
FABSEQ_INSTANTIATE_FUNCTION(check_build);
FABSEQ_INSTANTIATE_FUNCTION(check_places);
FABSEQ_INSTANTIATE_FUNCTION(report_build);

}  // namespace fabseq
