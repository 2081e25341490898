// SPDX-License-Identifier: MIT
/// Constraint: the build direction stays within the torch's largest tilt (docs/formulation.md 13.2).
#include "fabseq/base/mpi.h"
#include "fabseq/responses/response_type.h"
#include "responses/smooth_excess.h"
#include "responses/unit_gradient.h"

#include <numbers>

namespace fabseq {

namespace {

/// Where a limit that adapts begins.
constexpr double first_limit = 1e-3;

struct TiltSettings {
  std::optional<double> limit;  ///< none: it adapts
  double width = 5.0;           ///< degrees
  double margin = 0.0;          ///< degrees

  void check(const TermPlace& place) const {
    if (margin >= place.tool.max_tilt)
      refuse(pointer_to(place.pointer, "margin"), shown(margin),
             "less than tool.max_tilt, " + shown(place.tool.max_tilt));
    if (!place.tool.axis.empty())
      refuse(pointer_to(place.pointer, "type"), "\"tilt\" with a fixed tool.axis",
             "\"tilt\" with tool.axis \"normal\"");
    if (place.tool.max_tilt >= 180.0)
      refuse("/tool/max_tilt", shown(place.tool.max_tilt) + " with a constraint tilt", "less than 180");
  }
};

/// One component: the share of the part built beyond the largest tilt, smoothly counted: mean of
/// E((cos(max_tilt - margin) - a . up) / epsilon), with E the smooth excess.
template <int Dim>
class Tilt : public Response<Dim> {
 public:
  Tilt(const ResponseContext<Dim>& context, const TiltSettings& settings)
      : context_(context),
        limit_(settings.limit),
        up_(context.part.plate().template normal<Dim>()),
        cosine_(std::cos(radians(context.tool.max_tilt - settings.margin))) {
    const double largest = context.tool.max_tilt - settings.margin, half = 0.5 * settings.width;
    const double from = std::clamp(largest - half, 0.0, 180.0), to = std::clamp(largest + half, 0.0, 180.0);
    // The slope of E rises from 0.12 to 0.88 of its largest within the width.
    epsilon_ = 0.25 * (std::cos(radians(from)) - std::cos(radians(to)));
  }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    double total = 0.0;
    for_each(state, [&](std::size_t e, int sub_part, double density) {
      total += density * beyond(direction(state, e, sub_part).vector).value;
    });
    const MPI_Comm comm = context_.part.grid().comm();
    return {sum(comm, total) * context_.part.grid().element_volume() / context_.part.volume()};
  }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    weight *= context_.part.grid().element_volume() / context_.part.volume();
    const SubParts& sub_parts = state.densities->sub_parts;
    for_each(state, [&](std::size_t e, int sub_part, double density) {
      const UnitGradient<Dim> axis = direction(state, e, sub_part);
      const SmoothExcess excess = beyond(axis.vector);
      const double factor = -weight * density * excess.slope / epsilon_;
      Point<Dim> d_axis;
      for (int i = 0; i < Dim; ++i) d_axis[i] = factor * up_[i];
      if (sub_part < 0) {
        axis.add_derivative(d_axis, &DensityDerivatives::zeros_if_empty(
                                        adjoint.time.gradient, state.time->gradient.size())[e * Dim]);
        return;
      }
      adjoint.densities.sub_part_or_zeros(sub_parts, sub_part)[e] +=
          weight * context_.weight_of(e) * excess.value;
      for (int i = 0; i < Dim; ++i)
        adjoint.densities.directions_or_zeros(sub_parts)[static_cast<std::size_t>(sub_part) * Dim + i] +=
            d_axis[i];
    });
  }

  std::vector<ConstraintRow> rows(double margin) const override {
    return {excess_bound(limit_, first_limit, margin)};
  }

 private:
  static double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

  /// Calls what(part element, sub-part or -1, how much the element counts in it).
  template <class What>
  void for_each(const StageResults<Dim>& state, What&& what) const {
    const SubParts& sub_parts = state.densities->sub_parts;
    const std::vector<double>& density = context_.part.part_density();
    for (std::size_t e = 0; e < density.size(); ++e) {
      const double counts = context_.weight_of(e);
      if (sub_parts.count() == 0) what(e, -1, counts * density[e]);
      for (int i = 0; i < sub_parts.count(); ++i) what(e, i, counts * sub_parts.density[i][e]);
    }
  }

  UnitGradient<Dim> direction(const StageResults<Dim>& state, std::size_t e, int sub_part) const {
    if (sub_part < 0)
      return UnitGradient<Dim>(&state.time->gradient[e * Dim], context_.characteristic_length);
    UnitGradient<Dim> result;
    std::copy_n(&state.densities->sub_parts.directions[static_cast<std::size_t>(sub_part) * Dim], Dim,
                result.vector.begin());
    return result;
  }

  SmoothExcess beyond(const Point<Dim>& axis) const {
    return SmoothExcess((cosine_ - dot(axis, up_)) / epsilon_);
  }

  ResponseContext<Dim> context_;
  std::optional<double> limit_;
  Point<Dim> up_;
  double cosine_, epsilon_ = 0.0;
};

const ResponseTraits tilt_traits{.list = TermList::constraints,
                                 .name = "tilt",
                                 .needs_time_gradient = true,
                                 .unit = share_of_part,
                                 .exact_check = "tilt"};
const Registered<Tilt, TiltSettings> registered(
    tilt_traits, Section<TiltSettings>("constraints")
                     .key("limit", &TiltSettings::limit,
                          "Largest share of the part beyond tool.max_tilt; auto: as the exact checks tell",
                          {.range = "(0, 1)", .words = "auto"})
                     .key("width", &TiltSettings::width, "Range within which the count becomes steep",
                          {.range = "(0, 90]", .unit = "degrees"})
                     .key("margin", &TiltSettings::margin, "Distance that the count keeps from tool.max_tilt",
                          {.range = "[0, 90)", .unit = "degrees"}));

}  // namespace

}  // namespace fabseq
