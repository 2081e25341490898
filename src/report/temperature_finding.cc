// SPDX-License-Identifier: MIT
/// \file
/// Temperatures at which layers begin, and the pauses that keep them low, of runs with a block `thermal`.
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/chain/part_temperature.h"
#include "fabseq/grid/corner_means.h"
#include "fabseq/report/finding.h"
#include "report/temperature_numbers.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

/// The temperature of every part element when each layer ends, for what is asked of it.
template <int Dim>
class ElementTemperatures {
 public:
  explicit ElementTemperatures(const MeasuredSequence<Dim>& sequence)
      : part_(sequence.part()),
        temperatures_(*sequence.state->temperatures),
        ambient_(sequence.settings().thermal->ambient),
        layer_(sequence.layer_index),
        field_(layer_.size(), 0.0) {
    for (int number = 0; number < temperatures_.count(); ++number) add_layer(number);
  }

  std::vector<double> field() && { return std::move(field_); }
  const LayerTemperature& hottest() const { return hottest_; }

 private:
  /// Adds the temperatures that stand when the layer ends.
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
        corner_means(part_.grid(), part_.first_corners(),
                     spread_out(temperatures_.at_end(number), temperatures_.nodes, nodes));
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

/// Measurement of runs whose strain follows the temperature.
struct MeasuredTemperature {
  template <int Dim>
  static std::optional<TemperatureNumbers> measure(const MeasuredSequence<Dim>& sequence,
                                                   BuildFields& fields) {
    const StageResults<Dim>& state = *sequence.state;
    if (!state.temperatures) return std::nullopt;
    const std::vector<double>& interpass = state.temperatures->interpass;
    TemperatureNumbers result;
    const auto highest = std::ranges::max_element(interpass);
    result.highest = {*highest, static_cast<int>(highest - interpass.begin()) + 1, {}};
    ElementTemperatures<Dim> elements(sequence);
    result.hottest = elements.hottest();
    fields.add({"interpass_temperature", std::move(elements).field()});
    // They take solves of their own.
    if (const auto limit = sequence.settings().thermal->interpass_limit; limit && sequence.with_shape)
      result.pauses = pause_numbers(sequence.model, *state.densities, *limit);
    return result;
  }
};

const RegisteredFinding<MeasuredTemperature> registered_temperature({"interpass", 110,
                                                                     MeasuredIn::evaluations});

}  // namespace

void TemperatureNumbers::add_record(Json& block) const {
  Json record = Json::object({{"highest", Json::object({{"value", highest.value}, {"layer", highest.layer}})},
                              {"hottest_element", Json()}});
  if (hottest.layer > 0)
    record["hottest_element"] =
        Json::object({{"value", hottest.value}, {"layer", hottest.layer}, {"at", hottest.at}});
  if (pauses) {
    Json seconds = Json::array();
    for (const auto& pause : pauses->seconds) seconds.push_back(pause ? Json(*pause) : Json());
    record["pauses"] = seconds;
    record["build_hours"] = pauses->hours ? Json(*pauses->hours) : Json();
  }
  block["interpass"] = record;
}

std::vector<TableCell> TemperatureNumbers::cells(const Found& /*all*/) const {
  return {{30, "interpass, deg C", highest.layer > 0 ? formatted("%.0f", highest.value) : "-"}};
}

}  // namespace fabseq
