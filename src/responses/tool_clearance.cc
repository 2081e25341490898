// SPDX-License-Identifier: MIT
/// Constraint: the torch has room where it deposits (docs/formulation.md 13.2).
#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"
#include "fabseq/machine/least_rotation.h"
#include "fabseq/machine/torch.h"
#include "fabseq/responses/response_type.h"
#include "responses/smooth_excess.h"
#include "responses/unit_gradient.h"

#include <algorithm>
#include <cstdint>

namespace fabseq {

namespace {

/// Where a limit that adapts begins.
constexpr double first_limit = 3e-6;
/// Pseudo-time of the substrate: earlier than any layer.
constexpr double substrate_time = -1.0;

struct ToolClearanceSettings {
  std::optional<double> limit;  ///< none: it adapts
  int samples = 200;
  double delay = 0.5;       ///< in layers
  double sharpness = 0.05;  ///< in layers

  void check(const TermPlace& place) const {
    if (place.tool.profile.empty())
      refuse("/tool/profile", "[] with a constraint tool_clearance", "pairs of a height and a radius");
  }
};

/// One component: the share of the torch that meets what stands, mean over the part, smoothly counted. For
/// sample points y_m of the torch at each element x, it sums over the elements c around y_m
/// N_c(y_m) rho_c E((t(x) - t_c - delay) / sharpness), with N_c the weights of linear interpolation between
/// centres and E the smooth excess.
template <int Dim>
class ToolClearance : public Response<Dim> {
 public:
  ToolClearance(const ResponseContext<Dim>& context, const ToolClearanceSettings& settings)
      : context_(context),
        settings_(settings),
        up_(context.part.plate().template normal<Dim>()),
        samples_(torch_samples<Dim>(context.tool, up_, diagonal(context.part.grid()), settings.samples)),
        halo_(context.part.grid(), width(context)),
        density_(halo_.gather(standing_density(context.part))),
        cells_(ringed(halo_.box())),
        material_around_(material_around()) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const Field field = gather(state);
    double total = 0.0;
    for_each_element(state, [&](std::size_t e, const Place& place, const LeastRotation<Dim>& rotation) {
      double blocked = 0.0;
      for (const Point<Dim>& sample : samples_)
        for_each_corner(place, rotation.apply(sample), [&](std::size_t c, double weight, const Point<Dim>&) {
          blocked += weight * density_[c] * field.earlier(c, place.time).value;
        });
      total += counts(e) * blocked;
    });
    return {sum(context_.part.grid().comm(), total) * unit()};
  }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const Field field = gather(state);
    const std::size_t elements = context_.part.part_density().size();
    auto& d_time = DensityDerivatives::zeros_if_empty(adjoint.time.time, elements);
    std::vector<double> d_field(field.time.size());
    for_each_element(state, [&](std::size_t e, const Place& place, const LeastRotation<Dim>& rotation) {
      const double factor = weight * unit() * counts(e);
      Point<Dim> d_axis{};
      for (const Point<Dim>& sample : samples_) {
        Point<Dim> d_offset{};
        for_each_corner(
            place, rotation.apply(sample), [&](std::size_t c, double share, const Point<Dim>& d_share) {
              const SmoothExcess earlier = field.earlier(c, place.time);
              const double by_time = factor * share * density_[c] * earlier.slope / field.sharpness;
              d_time[e] += by_time;
              d_field[c] -= by_time;
              for (int i = 0; i < Dim; ++i) d_offset[i] += factor * density_[c] * earlier.value * d_share[i];
            });
        rotation.add_derivative(sample, d_offset, d_axis);
      }
      if (turns()) direction(state, e).add_derivative(d_axis, &gradient_or_zeros(state, adjoint)[e * Dim]);
    });
    const std::vector<double> of_others = context_.part.restrict_to_part(halo_.scatter_add(d_field));
    for (std::size_t e = 0; e < elements; ++e) d_time[e] += of_others[e];
  }

  std::vector<ConstraintRow> rows(double margin) const override {
    return {excess_bound(settings_.limit, first_limit, margin)};
  }

 private:
  /// Pseudo-times in the box of the halo, and how much earlier one is than another.
  struct Field {
    std::vector<double> time;
    double delay, sharpness;
    SmoothExcess earlier(std::size_t c, double than) const {
      return SmoothExcess((than - time[c] - delay) / sharpness);
    }
  };
  struct Place {
    Index<Dim> element;
    double time;
  };

  static double diagonal(const Grid<Dim>& grid) {
    return std::sqrt(dot(grid.domain().size, grid.domain().size));
  }
  /// One element more than the torch, since fields are interpolated.
  static Index<Dim> width(const ResponseContext<Dim>& context) {
    Index<Dim> result = torch_halo(context.part.grid(), Torch(context.tool));
    for (int& elements : result) ++elements;
    return result;
  }
  /// 1 on the substrate.
  static std::vector<double> standing_density(const Part<Dim>& part) {
    return part.expand(part.part_density(), 0.0, 1.0);
  }

  /// Whether any of the elements around a cell holds material.
  std::vector<char> material_around() const {
    std::vector<char> result(static_cast<std::size_t>(cells_.count()), 0);
    halo_.box().for_each([&](const Index<Dim>& element, std::int64_t c) {
      if (density_[c] == 0.0) return;
      for (int number = 0; number < corner_count<Dim>; ++number)
        result[cells_.offset(stepped<Dim>(element, number, -1))] = 1;
    });
    return result;
  }

  Field gather(const StageResults<Dim>& state) const {
    const double layer = 1.0 / state.densities->count();
    const Part<Dim>& part = context_.part;
    return {halo_.gather(part.expand(state.time->time, 0.0, substrate_time)), settings_.delay * layer,
            settings_.sharpness * layer};
  }
  /// How much an element counts.
  double counts(std::size_t e) const { return context_.weight_of(e) * context_.part.part_density()[e]; }
  /// What a blocked sample of an element adds to the mean.
  double unit() const {
    return context_.part.grid().element_volume() /
           (context_.part.volume() * static_cast<double>(samples_.size()));
  }
  bool turns() const { return context_.tool.axis.empty(); }
  UnitGradient<Dim> direction(const StageResults<Dim>& state, std::size_t e) const {
    return UnitGradient<Dim>(&state.time->gradient[e * Dim], context_.characteristic_length);
  }
  static std::vector<double>& gradient_or_zeros(const StageResults<Dim>& state,
                                                StageDerivatives<Dim>& adjoint) {
    return DensityDerivatives::zeros_if_empty(adjoint.time.gradient, state.time->gradient.size());
  }
  /// Calls what(part element, its place, rotation of the torch there) for those that count.
  template <class What>
  void for_each_element(const StageResults<Dim>& state, What&& what) const {
    const Part<Dim>& part = context_.part;
    const Point<Dim> fixed = turns() ? up_ : fixed_torch_axis<Dim>(context_.tool);
    for (std::size_t e = 0; e < part.elements().size(); ++e) {
      if (context_.weight_of(e) == 0.0) continue;
      const Point<Dim> axis = turns() ? direction(state, e).vector : fixed;
      what(e, Place{part.grid().owned_elements().index(part.elements()[e]), state.time->time[e]},
           LeastRotation<Dim>(up_, axis));
    }
  }

  /// Calls what(position in the halo's box, weight N_c, its derivative with respect to the offset) for the
  /// elements around a point that hold material.
  template <class What>
  void for_each_corner(const Place& place, const Point<Dim>& offset, What&& what) const {
    const Point<Dim>& spacing = context_.part.grid().spacing();
    Index<Dim> first = place.element;
    Point<Dim> rest;
    for (int i = 0; i < Dim; ++i) {
      const double steps = offset[i] / spacing[i], whole = std::floor(steps);
      first[i] += static_cast<int>(whole);
      rest[i] = steps - whole;
    }
    if (!cells_.contains(first) || material_around_[cells_.offset(first)] == 0) return;
    for (int number = 0; number < corner_count<Dim>; ++number) {
      const Index<Dim> corner = stepped<Dim>(first, number, 1);
      if (!halo_.box().contains(corner)) continue;
      const auto c = static_cast<std::size_t>(halo_.box().offset(corner));
      if (density_[c] == 0.0) continue;
      double weight = 1.0;
      Point<Dim> slope;
      slope.fill(1.0);
      for (int i = 0; i < Dim; ++i) {
        const bool upper = (number >> i & 1) != 0;
        const double share = upper ? rest[i] : 1.0 - rest[i], d_share = (upper ? 1.0 : -1.0) / spacing[i];
        weight *= share;
        for (int k = 0; k < Dim; ++k) slope[k] *= k == i ? d_share : share;
      }
      what(c, weight, slope);
    }
  }

  ResponseContext<Dim> context_;
  ToolClearanceSettings settings_;
  Point<Dim> up_;
  std::vector<Point<Dim>> samples_;
  ElementHalo<Dim> halo_;
  std::vector<double> density_;
  IndexBox<Dim> cells_;                ///< between the centres of 2^Dim elements each, by the lowest of these
  std::vector<char> material_around_;  ///< [cell]
};

const Registered<ToolClearance, ToolClearanceSettings> registered(
    {.list = TermList::constraints,
     .name = "tool_clearance",
     .layers = LayerKind::curved,
     .needs_torch_axis = true,
     .unit = share_of_part,
     .exact_check = "blocked"},
    Section<ToolClearanceSettings>("constraints")
        .key("limit", &ToolClearanceSettings::limit,
             "Largest mean fraction of the torch obstructed by deposited material; auto: as the exact checks "
             "tell",
             {.range = "(0, 1)", .words = "auto"})
        .key("samples", &ToolClearanceSettings::samples, "Points that sample the torch",
             {.range = "[1, 100000]"})
        .key("delay", &ToolClearanceSettings::delay, "Material earlier by this many layers obstructs",
             {.range = "[0, 10]"})
        .key("sharpness", &ToolClearanceSettings::sharpness, "Layers within which the count becomes steep",
             {.range = "(0, 10]"}));

}  // namespace

}  // namespace fabseq
