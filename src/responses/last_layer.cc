// SPDX-License-Identifier: MIT
/// Constraint: the part ends with a layer of some size, not with a sliver (docs/formulation.md 6).
#include "fabseq/base/mpi.h"
#include "fabseq/responses/layer_statistics.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Elements count from this long before the end of the last layer on, in units of a layer's pseudo-time.
constexpr double approach = 0.25;
/// The bound for the optimizer lies below the user's by this factor times (1 - margin), in layers: a step
/// moves times by some percent of a layer, and smooth layers reach a little further than binary ones.
constexpr double caution = 3.0;
/// Exponent of the norm, which is nearly the largest entry.
constexpr int power = 8;

struct LastLayerSettings {
  double least_volume = 0.05;
};

/// Curved layers only. Let j be the last layer with at least `least_volume` of the mean volume V*/N. The one
/// component says by how much elements are later than that layer: (sum_e max(0, N (t_e - T_j) +
/// 0.25)^8)^(1/8), in layers, at most 0.25, so that no element belongs to a later layer. It is 0 if j is the
/// last of all layers.
template <int Dim>
class LastLayer : public Response<Dim> {
 public:
  LastLayer(const ResponseContext<Dim>& context, const LastLayerSettings& settings)
      : grid_(context.part.grid()), least_of_all_(settings.least_volume * context.part.volume()) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    return {norm(lateness(state, last_whole(*state.densities)))};
  }

  void add_derivative(int /*component*/, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const int last = last_whole(*state.densities);
    const std::vector<double> late = lateness(state, last);
    const double value = norm(late);
    if (value == 0.0) return;
    auto& d_time = DensityDerivatives::zeros_if_empty(adjoint.time.time, late.size());
    double total = 0.0;
    for (std::size_t e = 0; e < late.size(); ++e) {
      const double derivative = weight * state.densities->count() * std::pow(late[e] / value, power - 1);
      d_time[e] += derivative;
      total += derivative;
    }
    adjoint.densities.time_points_or_zeros()[last] -= sum(grid_.comm(), total);
  }

  std::vector<ConstraintRow> rows(double margin) const override {
    return {{1.0, std::max(0.0, approach - caution * (1.0 - margin))}};
  }

 private:
  /// Number, from 1, of the last layer that is not a sliver. Collective.
  int last_whole(const LayerDensities& layers) const {
    const std::vector<double> volume = layer_volumes(grid_, layers);
    int last = layers.count();
    while (last > 1 && volume[last - 1] * layers.count() < least_of_all_) --last;
    return last;
  }

  /// Part field: how many layers later than the end of layer `last` each element is, plus `approach`; 0 for
  /// elements that do not count.
  std::vector<double> lateness(const StageResults<Dim>& state, int last) const {
    std::vector<double> result(state.time->time.size(), 0.0);
    if (last == state.densities->count()) return result;
    for (std::size_t e = 0; e < result.size(); ++e)
      result[e] = std::max(
          0.0,
          state.densities->count() * (state.time->time[e] - state.densities->time_points[last]) + approach);
    return result;
  }

  double norm(const std::vector<double>& late) const {
    double total = 0.0;
    for (const double value : late) total += std::pow(value, power);
    return std::pow(sum(grid_.comm(), total), 1.0 / power);
  }

  const Grid<Dim>& grid_;
  double least_of_all_;  ///< least volume of a layer times the number of layers
};

const Registered<LastLayer, LastLayerSettings> registered(
    {.list = TermList::constraints, .name = "last_layer", .layers = LayerKind::curved},
    Section<LastLayerSettings>("constraints")
        .key("least_volume", &LastLayerSettings::least_volume,
             "No element is later than the last layer of this volume, relative to the mean",
             {.range = "(0, 1)"}));

}  // namespace

}  // namespace fabseq
