// SPDX-License-Identifier: MIT
/// Constraint: layers are nowhere thinner or thicker than the process can deposit (docs/formulation.md 13.2).
#include "fabseq/base/mpi.h"
#include "fabseq/responses/layer_statistics.h"
#include "fabseq/responses/response_type.h"
#include "responses/smooth_excess.h"

#include <algorithm>
#include <array>

namespace fabseq {

namespace {

/// Where a limit that adapts begins.
constexpr double first_limit = 1e-3;

/// Least local thickness whose logarithm is taken, relative to the target: smooth layers may overlap.
constexpr double least_thickness = 1e-6;

struct LocalThicknessSettings {
  std::optional<double> limit;  ///< none: it adapts
  double width = 0.1;
  double margin = 0.0;

  /// Largest and least thickness that the count allows, in the unit of the range: elements that it barely
  /// misses, and those that leave it in binary layers only, stay within the range of the exact check.
  std::array<double, 2> ends(const std::array<double, 2>& range) const {
    return {(1.0 - margin) * range[1], (1.0 + margin) * range[0]};
  }

  void check(const TermPlace& place) const {
    if (const auto [high, low] = ends(place.tool.thickness); low >= high)
      refuse(pointer_to(place.pointer, "margin"), shown(margin),
             "one that leaves a part of the range of tool.thickness");
    if (!place.layers.target)
      refuse(pointer_to(place.pointer, "type"), "\"local_thickness\" without a target",
             "a constraint layer_thickness, whose target it is measured by");
  }
};

/// Two components: the shares of the part that are thicker and thinner than tool.thickness less the margin,
/// smoothly counted: mean of E(+-ln(d_e / end) / epsilon), with E the smooth excess and
/// d_e = (sum_j drho^j (T_j - T_{j-1}) / rho + b_e) / M_e, where b_e is how far t_e is before T_0 or after
/// T_N.
template <int Dim>
class LocalThickness : public Response<Dim> {
 public:
  LocalThickness(const ResponseContext<Dim>& context, const LocalThicknessSettings& settings)
      : context_(context),
        limit_(settings.limit),
        epsilon_(0.25 * settings.width),
        smallest_(least_thickness * context.target_thickness),
        ends_(settings.ends(context.tool.thickness)) {
    for (double& end : ends_) end *= context.target_thickness;
  }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const std::vector<double> magnitude = gradient_magnitude(*state.time, context_.characteristic_length);
    const std::vector<double> duration = durations(state);
    std::vector<double> result(2);
    for (std::size_t e = 0; e < magnitude.size(); ++e)
      for (int side = 0; side < 2; ++side)
        result[side] += counts(e) * beyond(side, duration[e] / magnitude[e]).value;
    sum_in_place(context_.part.grid().comm(), result);
    for (double& value : result) value *= context_.part.grid().element_volume() / context_.part.volume();
    return result;
  }

  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    weight *= context_.part.grid().element_volume() / context_.part.volume();
    const std::vector<double> magnitude = gradient_magnitude(*state.time, context_.characteristic_length);
    const std::vector<double> duration = durations(state);
    std::vector<double> d_magnitude(magnitude.size()), d_duration(magnitude.size());
    for (std::size_t e = 0; e < magnitude.size(); ++e) {
      const double thickness = duration[e] / magnitude[e];
      if (thickness <= smallest_) continue;
      // d(ln d) = d(duration) / duration - d(magnitude) / magnitude
      const double factor =
          weight * counts(e) * sign(component) * beyond(component, thickness).slope / epsilon_;
      d_duration[e] = factor / duration[e];
      d_magnitude[e] = -factor / magnitude[e];
    }
    add_magnitude_derivative(state, magnitude, d_magnitude, adjoint);
    add_duration_derivative(*state.densities, d_duration, adjoint.densities);
    auto& d_time = DensityDerivatives::zeros_if_empty(adjoint.time.time, d_duration.size());
    for (std::size_t e = 0; e < d_duration.size(); ++e) {
      if (state.time->time[e] > state.densities->time_points.back()) d_time[e] += d_duration[e];
      if (state.time->time[e] < state.densities->time_points.front()) d_time[e] -= d_duration[e];
    }
  }

  std::vector<ConstraintRow> rows(double margin) const override {
    return {excess_bound(limit_, first_limit, margin)};
  }

 private:
  /// How much an element counts.
  double counts(std::size_t e) const { return context_.weight_of(e) * context_.part.part_density()[e]; }
  static double sign(int side) { return side == 0 ? 1.0 : -1.0; }
  SmoothExcess beyond(int side, double thickness) const {
    return SmoothExcess(sign(side) * std::log(std::max(thickness, smallest_) / ends_[side]) / epsilon_);
  }

  /// Pseudo-time that the layer of each element takes up to it, if it is beyond all layers' time.
  std::vector<double> durations(const StageResults<Dim>& state) const {
    const LayerDensities& layers = *state.densities;
    std::vector<double> result(context_.part.part_density().size());
    for (std::size_t e = 0; e < result.size(); ++e) result[e] = layers.beyond(state.time->time[e]);
    for (int j = 0; j < layers.count(); ++j) {
      const double time = layers.time_points[j + 1] - layers.time_points[j];
      for (std::size_t e = 0; e < result.size(); ++e)
        result[e] += layers.layer[j][e] * time / context_.part.part_density()[e];
    }
    return result;
  }

  void add_duration_derivative(const LayerDensities& layers, const std::vector<double>& d_duration,
                               DensityDerivatives& derivatives) const {
    const std::vector<double>& density = context_.part.part_density();
    std::vector<double> d_time(static_cast<std::size_t>(layers.count()));
    for (int j = 0; j < layers.count(); ++j) {
      const double time = layers.time_points[j + 1] - layers.time_points[j];
      auto& d_layer = DensityDerivatives::zeros_if_empty(derivatives.layer[j], density.size());
      for (std::size_t e = 0; e < density.size(); ++e) {
        d_layer[e] += d_duration[e] * time / density[e];
        d_time[j] += d_duration[e] * layers.layer[j][e] / density[e];
      }
    }
    sum_in_place(context_.part.grid().comm(), d_time);
    auto& d_time_points = derivatives.time_points_or_zeros();
    for (int j = 0; j < layers.count(); ++j) {
      d_time_points[j + 1] += d_time[j];
      d_time_points[j] -= d_time[j];
    }
  }

  ResponseContext<Dim> context_;
  std::optional<double> limit_;
  double epsilon_, smallest_;
  std::array<double, 2> ends_;  ///< largest and least thickness, length unit
};

const Registered<LocalThickness, LocalThicknessSettings> registered(
    {.list = TermList::constraints,
     .name = "local_thickness",
     .layers = LayerKind::curved,
     .needs_time_gradient = true,
     .unit = share_of_part,
     .exact_check = "local_thickness"},
    Section<LocalThicknessSettings>("constraints")
        .key("limit", &LocalThicknessSettings::limit,
             "Largest share of the part above tool.thickness, and below it; auto: as the exact checks tell",
             {.range = "(0, 1)", .words = "auto"})
        .key("width", &LocalThicknessSettings::width, "Relative range within which the count becomes steep",
             {.range = "(0, 1]"})
        .key("margin", &LocalThicknessSettings::margin,
             "Relative distance that the count keeps from both ends of tool.thickness",
             {.range = "[0, 0.5]"}));

}  // namespace

}  // namespace fabseq
