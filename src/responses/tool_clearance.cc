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
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

/// Where a limit that adapts begins.
constexpr double first_limit = 3e-6;
/// Pseudo-time of the substrate: earlier than any layer.
constexpr double substrate_time = -1.0;
/// Place, in units of the sharpness, where the smooth excess is 4e-22 and nothing beside the smallest limit.
constexpr double nothing = -50.0;

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
/// centres and E the smooth excess. The mean and its derivatives are found in one pass and kept: a design and
/// its binary layers have the same pseudo-time.
template <int Dim>
class ToolClearance : public Response<Dim> {
 public:
  ToolClearance(const ResponseContext<Dim>& context, const ToolClearanceSettings& settings)
      : context_(context),
        settings_(settings),
        up_(context.part.plate().template normal<Dim>()),
        samples_(torch_samples<Dim>(context.tool, up_, diagonal(context.part.grid()), settings.samples)),
        halo_(context.part.grid(), width(context)),
        box_(ringed(halo_.box())),
        density_(ringed_field(standing_density(context.part))) {
    for (int number = 0; number < corner_count<Dim>; ++number)
      steps_[number] = box_.offset(stepped<Dim>(box_.start, number, 1));
    for (int i = 0; i < Dim; ++i) per_length_[i] = 1.0 / context.part.grid().spacing()[i];
  }

  std::vector<double> values(const StageResults<Dim>& state) const override { return {mean(state).value}; }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const Mean& of = mean(state);
    const auto add = [weight](const std::vector<double>& derivative, std::vector<double>& sum) {
      DensityDerivatives::zeros_if_empty(sum, derivative.size());
      for (std::size_t i = 0; i < derivative.size(); ++i) sum[i] += weight * derivative[i];
    };
    add(of.d_time, adjoint.time.time);
    if (turns()) add(of.d_gradient, adjoint.time.gradient);
  }

  std::vector<ConstraintRow> rows(double margin) const override {
    return {excess_bound(settings_.limit, first_limit, margin)};
  }

 private:
  /// What the mean depends on, on this rank.
  struct Inputs {
    std::vector<double> time, gradient, weights;
    int layers = 0;  ///< none yet
    bool operator==(const Inputs&) const = default;
  };
  struct Mean {
    double value = 0.0;
    std::vector<double> d_time, d_gradient;  ///< part fields; [part element][axis]
  };
  /// Pseudo-times in box_, and how much earlier than another they have to be.
  struct Field {
    std::vector<double> time;
    std::vector<double> earliest_around;  ///< [cell]: of the elements around that hold material, or infinity
    double delay, sharpness;

    double beyond(double time_of_torch, double earlier) const { return time_of_torch - earlier - delay; }
    bool counts_for_nothing(double beyond) const { return beyond < nothing * sharpness; }
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
  /// An element field in box_, 0 beyond the halo's.
  std::vector<double> ringed_field(const std::vector<double>& owned) const {
    std::vector<double> result(static_cast<std::size_t>(box_.count()));
    const std::vector<double> gathered = halo_.gather(owned);
    halo_.box().for_each(
        [&](const Index<Dim>& element, std::int64_t c) { result[box_.offset(element)] = gathered[c]; });
    return result;
  }
  /// Transpose of the last one.
  std::vector<double> sums_of_owners(const std::vector<double>& ringed) const {
    std::vector<double> result(static_cast<std::size_t>(halo_.box().count()));
    halo_.box().for_each(
        [&](const Index<Dim>& element, std::int64_t c) { result[c] = ringed[box_.offset(element)]; });
    return context_.part.restrict_to_part(halo_.scatter_add(result));
  }

  /// Returns Field::earliest_around for times in box_.
  std::vector<double> earliest_around(const std::vector<double>& time) const {
    std::vector<double> result(time.size(), std::numeric_limits<double>::infinity());
    halo_.box().for_each([&](const Index<Dim>& element, std::int64_t) {
      const std::int64_t c = box_.offset(element);
      if (density_[c] == 0.0) return;
      for (const std::int64_t step : steps_) result[c - step] = std::min(result[c - step], time[c]);
    });
    return result;
  }

  /// Returns the mean of a state, which is kept until any rank has other inputs. Collective on the grid's
  /// communicator.
  const Mean& mean(const StageResults<Dim>& state) const {
    Inputs inputs{state.time->time, state.time->gradient, {}, state.densities->count()};
    if (context_.element_weights != nullptr) inputs.weights = *context_.element_weights;
    if (any(context_.part.grid().comm(), !(inputs == of_))) mean_ = new_mean(state);
    of_ = std::move(inputs);
    return mean_;
  }

  Mean new_mean(const StageResults<Dim>& state) const {
    const Part<Dim>& part = context_.part;
    const double layer = 1.0 / state.densities->count();
    std::vector<double> time = ringed_field(part.expand(state.time->time, 0.0, substrate_time));
    std::vector<double> earliest = earliest_around(time);
    const Field field{std::move(time), std::move(earliest), settings_.delay * layer,
                      settings_.sharpness * layer};
    Mean result{.d_time = std::vector<double>(part.elements().size()),
                .d_gradient = std::vector<double>(turns() ? state.time->gradient.size() : 0)};
    std::vector<double> d_field(field.time.size());
    for_each_element(state, [&](std::size_t e, const Place& place, const LeastRotation<Dim>& rotation) {
      const double factor = unit() * context_.weight_of(e) * part.part_density()[e];
      Point<Dim> d_axis{};
      for (const Point<Dim>& sample : samples_) {
        Point<Dim> d_offset{};
        bool meets = false;
        for_each_corner(
            field, place, rotation.apply(sample),
            [&](std::int64_t c, double share, const Point<Dim>& d_share, const SmoothExcess& earlier) {
              meets = true;
              const double by = factor * density_[c], by_time = by * share * earlier.slope / field.sharpness;
              result.value += by * share * earlier.value;
              result.d_time[e] += by_time;
              d_field[c] -= by_time;
              for (int i = 0; i < Dim; ++i) d_offset[i] += by * earlier.value * d_share[i];
            });
        if (meets) rotation.add_derivative(sample, d_offset, d_axis);
      }
      if (turns()) direction(state, e).add_derivative(d_axis, &result.d_gradient[e * Dim]);
    });
    const std::vector<double> of_others = sums_of_owners(d_field);
    for (std::size_t e = 0; e < of_others.size(); ++e) result.d_time[e] += of_others[e];
    result.value = sum(part.grid().comm(), result.value);
    return result;
  }

  /// What a blocked sample of an element adds to the mean.
  double unit() const {
    return context_.part.grid().element_volume() /
           (context_.part.volume() * static_cast<double>(samples_.size()));
  }
  bool turns() const { return context_.tool.axis.empty(); }
  UnitGradient<Dim> direction(const StageResults<Dim>& state, std::size_t e) const {
    return UnitGradient<Dim>(&state.time->gradient[e * Dim], context_.characteristic_length);
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

  /// Calls what(position in box_, weight N_c, its derivative with respect to the offset, excess) for the
  /// elements around a point that hold material, and are not so much later that they count for nothing.
  template <class What>
  void for_each_corner(const Field& field, const Place& place, const Point<Dim>& offset, What&& what) const {
    Index<Dim> first = place.element;
    std::array<Point<2>, Dim> shares;  // of the lower and the upper side
    for (int i = 0; i < Dim; ++i) {
      const double steps = offset[i] * per_length_[i], whole = std::floor(steps);
      first[i] += static_cast<int>(whole);
      shares[i] = {1.0 - (steps - whole), steps - whole};
    }
    if (!box_.contains(first)) return;
    const std::int64_t cell = box_.offset(first);
    if (field.counts_for_nothing(field.beyond(place.time, field.earliest_around[cell]))) return;
    for (int number = 0; number < corner_count<Dim>; ++number) {
      const std::int64_t c = cell + steps_[number];
      const double beyond = field.beyond(place.time, field.time[c]);
      if (density_[c] == 0.0 || field.counts_for_nothing(beyond)) continue;
      double weight = 1.0;
      Point<Dim> slope;
      slope.fill(1.0);
      for (int i = 0; i < Dim; ++i) {
        const int upper = number >> i & 1;
        const double share = shares[i][upper], d_share = upper == 1 ? per_length_[i] : -per_length_[i];
        weight *= share;
        for (int k = 0; k < Dim; ++k) slope[k] *= k == i ? d_share : share;
      }
      what(c, weight, slope, SmoothExcess(beyond / field.sharpness));
    }
  }

  ResponseContext<Dim> context_;
  ToolClearanceSettings settings_;
  Point<Dim> up_;
  std::vector<Point<Dim>> samples_;
  ElementHalo<Dim> halo_;
  IndexBox<Dim> box_;  ///< the halo's and a ring of elements, and so cells between centres, by their lowest
  std::vector<double> density_;                        ///< in box_
  std::array<std::int64_t, corner_count<Dim>> steps_;  ///< from a cell to the elements around
  Point<Dim> per_length_;                              ///< elements, along each axis
  mutable Mean mean_;
  mutable Inputs of_;
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
