// SPDX-License-Identifier: MIT
/// Constraint: no element begins in the air (docs/formulation.md 13.2).
#include "fabseq/base/mpi.h"
#include "fabseq/responses/response_type.h"
#include "responses/smooth_excess.h"
#include "responses/support_below.h"
#include "responses/unit_gradient.h"

#include <algorithm>
#include <optional>

namespace fabseq {

namespace {

struct SupportedSettings {
  std::optional<double> limit;  ///< none: it adapts
  double sharpness = 0.04;      ///< in elements of build time
};

/// One component: the share of the part's elements that begin in the air, smoothly counted: mean of E(X) over
/// the elements, with E the smooth excess and X what SupportBelow says of an element.
template <int Dim>
class Supported : public Response<Dim> {
 public:
  Supported(const ResponseContext<Dim>& context, const SupportedSettings& settings)
      : context_(context),
        limit_(settings.limit),
        below_(context.part, context.tool.bead_width, settings.sharpness) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const std::vector<double> times = below_.gather(state.time->time);
    double total = 0.0;
    for_each(state, [&](std::size_t e, int, const BuildTime& when, const UnitGradient<Dim>&,
                        const Point<Dim>& axis) {
      if (const double counts = context_.weight_of(e); counts > 0.0)
        total += counts * SmoothExcess(below_.support(e, when, axis, times).lack).value;
    });
    return {sum(context_.part.grid().comm(), total) * unit()};
  }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const std::vector<double> times = below_.gather(state.time->time);
    const SubParts& sub_parts = state.densities->sub_parts;
    auto& d_time = DensityDerivatives::zeros_if_empty(adjoint.time.time, state.time->time.size());
    auto& d_gradient = DensityDerivatives::zeros_if_empty(adjoint.time.gradient, state.time->gradient.size());
    std::vector<double> d_times(times.size());
    for_each(state, [&](std::size_t e, int sub_part, const BuildTime& when, const UnitGradient<Dim>& gradient,
                        const Point<Dim>& axis) {
      if (context_.weight_of(e) == 0.0) return;
      const auto support = below_.support(e, when, axis, times);
      const double factor = weight * context_.weight_of(e) * unit() * SmoothExcess(support.lack).slope;
      const LackDerivative<Dim> by = below_.derivative(support, when, axis, factor, d_times);
      d_time[e] += by.time;
      // The clock is M_e times an edge.
      for (int i = 0; i < Dim; ++i) d_gradient[e * Dim + i] += by.clock * below_.edge() * gradient.vector[i];
      if (sub_part < 0) {
        gradient.add_derivative(by.axis, &d_gradient[e * Dim]);
        return;
      }
      auto& d_directions = adjoint.densities.directions_or_zeros(sub_parts);
      for (int i = 0; i < Dim; ++i) d_directions[static_cast<std::size_t>(sub_part) * Dim + i] += by.axis[i];
    });
    const std::vector<double> of_others = below_.scatter(d_times);
    for (std::size_t e = 0; e < d_time.size(); ++e) d_time[e] += of_others[e];
  }

  /// A limit that adapts begins with half of one element, which lets none hang.
  std::vector<ConstraintRow> rows(double margin) const override {
    return {excess_bound(limit_, 0.5 * unit(), margin)};
  }

 private:
  double unit() const { return 1.0 / static_cast<double>(context_.part.count()); }

  /// Calls what(part element, sub-part or -1, when it is built, grad t there, build direction) for each
  /// element and each sub-part that it may belong to.
  template <class What>
  void for_each(const StageResults<Dim>& state, What&& what) const {
    const SubParts& sub_parts = state.densities->sub_parts;
    for (std::size_t e = 0; e < state.time->time.size(); ++e) {
      const UnitGradient<Dim> gradient(&state.time->gradient[e * Dim], context_.characteristic_length);
      BuildTime when{.time = state.time->time[e], .clock = gradient.length * below_.edge()};
      if (sub_parts.count() == 0) what(e, -1, when, gradient, gradient.vector);
      for (int i = 0; i < sub_parts.count(); ++i) {
        when.of_sub_part = true;
        when.begin = i > 0 ? sub_parts.timestamps[i - 1] : -BuildTime::infinite;
        when.end = i + 1 < sub_parts.count() ? sub_parts.timestamps[i] : BuildTime::infinite;
        if (!below_.may_belong(when)) continue;
        Point<Dim> axis;
        std::copy_n(&sub_parts.directions[static_cast<std::size_t>(i) * Dim], Dim, axis.begin());
        what(e, i, when, gradient, axis);
      }
    }
  }

  ResponseContext<Dim> context_;
  std::optional<double> limit_;
  SupportBelow<Dim> below_;
};

const Registered<Supported, SupportedSettings> registered(
    {.list = TermList::constraints,
     .name = "supported",
     .needs_time_gradient = true,
     .unit = share_of_part,
     .exact_check = "hanging"},
    Section<SupportedSettings>("constraints")
        .key("limit", &SupportedSettings::limit,
             "Largest share of elements that begin in the air; auto: as the exact checks tell",
             {.range = "(0, 1)", .words = "auto"})
        .key("sharpness", &SupportedSettings::sharpness,
             "Range of the smooth count: build time of so many elements; in space a quarter",
             {.range = "(0, 1]"}));

}  // namespace

}  // namespace fabseq
