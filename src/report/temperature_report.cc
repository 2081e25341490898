// SPDX-License-Identifier: MIT
#include "fabseq/report/temperature_report.h"

#include "fabseq/base/mpi.h"
#include "fabseq/chain/part_temperature.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

/// The temperature of every part element when each layer ends, for what is asked of it.
template <int Dim>
class ElementTemperatures {
 public:
  ElementTemperatures(const Model<Dim>& model, const Pipeline<Dim>& pipeline, const StageResults<Dim>& state)
      : part_(model.part),
        temperatures_(*state.temperatures),
        ambient_(model.settings.thermal->ambient),
        layer_(pipeline.last_layer_index()),
        field_(layer_.size(), 0.0) {
    for (int number = 0; number < temperatures_.count(); ++number) add_layer(number);
  }

  std::vector<double> field() && { return std::move(field_); }
  const LayerTemperature& hottest() const { return hottest_; }

 private:
  /// Those that stand when the layer ends.
  void add_layer(int number) {
    const std::vector<double> mean = means_at_end(number);
    double highest = -std::numeric_limits<double>::infinity();
    for (std::size_t e = 0; e < mean.size(); ++e) {
      if (layer_[e] == number + 1) field_[e] = mean[e];
      if (layer_[e] <= number + 1) highest = std::max(highest, mean[e]);
    }
    highest = max(part_.grid().comm(), highest);
    const bool is_first = hottest_.layer == 0;
    if (number + 1 == temperatures_.count() || !(is_first || highest > hottest_.value)) return;
    if (highest == -std::numeric_limits<double>::infinity()) return;  // nothing stands yet
    const Point<Dim> place =
        part_.first_place([&](std::size_t e) { return layer_[e] <= number + 1 && mean[e] == highest; });
    hottest_ = {highest, number + 2, {place.begin(), place.end()}};
  }

  std::vector<double> means_at_end(int number) const {
    const auto nodes = static_cast<std::size_t>(part_.grid().owned_nodes().count());
    std::vector<double> result =
        part_means(part_, spread_out(temperatures_.at_end(number), temperatures_.nodes, nodes));
    for (double& mean : result) mean += ambient_;
    return result;
  }

  const Part<Dim>& part_;
  const LayerTemperatures& temperatures_;
  double ambient_;
  std::vector<double> layer_, field_;
  LayerTemperature hottest_;
};

template <int Dim>
PauseNumbers pause_numbers(const Model<Dim>& model, const LayerDensities& layers, double limit) {
  PartTemperature<Dim> temperature(model, model.settings.solver.finest_tolerance());
  NeededPauses needed = temperature.simulation.needed_pauses(layers, limit);
  PauseNumbers result{std::move(needed.seconds), needed.welding / seconds_per_hour};
  for (const auto& pause : result.seconds) {
    if (!pause) return {std::move(result.seconds), std::nullopt};
    *result.hours += model.settings.thermal->passes * *pause / seconds_per_hour;
  }
  return result;
}

}  // namespace

template <int Dim>
TemperatureReport report_temperature(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                                     const StageResults<Dim>& state, bool with_pauses) {
  const std::vector<double>& interpass = state.temperatures->interpass;
  TemperatureReport report;
  const auto highest = std::ranges::max_element(interpass);
  report.numbers.highest = {*highest, static_cast<int>(highest - interpass.begin()) + 1, {}};
  ElementTemperatures<Dim> elements(model, pipeline, state);
  report.numbers.hottest = elements.hottest();
  report.field = std::move(elements).field();
  if (const auto limit = model.settings.thermal->interpass_limit; limit && with_pauses)
    report.numbers.pauses = pause_numbers(model, *state.densities, *limit);
  return report;
}

FABSEQ_INSTANTIATE_FUNCTION(report_temperature);

}  // namespace fabseq
