// SPDX-License-Identifier: MIT
#include "thermal/pause_search.h"

#include "thermal/temperature_steps.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Steps of a pause grow, so that their error stays the same share of the time that has passed.
constexpr double growth = 1.3, first_step = 0.25;  ///< of the time of welding
constexpr double longest = 1e7;                    ///< s: four months
/// Where the pauses between the passes of a layer are sought, too, they are taken to agree this closely.
constexpr double agreement = 1e-3;
constexpr int most_rounds = 12;

/// A layer between two others on the way through the part.
template <int Dim>
class PauseSearch {
 public:
  PauseSearch(const ThermalModel<Dim>& model, HeatSolver<Dim>& solver, const SolveTolerance& tolerance,
              const std::vector<double>& density, const ThermalLayer& layer, int number, double excess)
      : model_(model),
        steps_(model, solver, tolerance),
        density_(density),
        layer_(layer),
        number_(number),
        excess_(excess),
        least_step_(first_step * std::max(layer.mass / model.properties.rate, 1.0)) {}

  /// Welds the layer, from theta and the capacity before it.
  void weld(const std::vector<double>& capacity_before, double inner_pause, std::vector<double>& theta) {
    const auto schedule = model_.steps(layer_.mass, inner_pause, 0.0);
    steps_.set(layer_, schedule.front().seconds);
    for (std::size_t i = 0; i < schedule.size(); ++i)
      steps_.advance(i == 0 ? capacity_before : layer_.capacity, 1.0 / model_.properties.welding_steps, theta,
                     step_name(number_, i));
  }

  /// Rests until the layer is at the limit; returns how long, negative if it does not get there.
  double rest(std::vector<double>& theta) {
    double passed = 0.0;
    for (double step = least_step_; warmth(theta) > excess_; step *= growth) {
      if (passed > longest) return -1.0;
      std::vector<double> next = theta;
      cool(step, next);
      if (warmth(next) <= excess_) {
        step = last_step(step, theta, next);
        theta = next;
        return passed + step;
      }
      passed += step;
      theta = std::move(next);
    }
    return passed;
  }

  void cool(double seconds, std::vector<double>& theta) {
    steps_.set(layer_, seconds);
    steps_.advance(layer_.capacity, 0.0, theta, step_name(number_, 0) + " of the pause");
  }

 private:
  double warmth(const std::vector<double>& theta) const { return model_.interpass(density_, theta); }

  /// The part of a step, from theta, that ends at the limit or just below; sets `next` to the state there.
  double last_step(double step, const std::vector<double>& theta, std::vector<double>& next) {
    double low = 0.0, high = step, at_low = warmth(theta), at_high = warmth(next);
    for (int round = 0; round < most_rounds && high - low > agreement * step; ++round) {
      const double share = std::clamp((at_low - excess_) / (at_low - at_high), 0.05, 0.95);
      const double middle = low + share * (high - low);
      std::vector<double> there = theta;
      cool(middle, there);
      const double at_middle = warmth(there);
      if (at_middle > excess_) {
        low = middle;
        at_low = at_middle;
      } else {
        high = middle;
        at_high = at_middle;
        next = std::move(there);
      }
      if (std::abs(at_middle - excess_) <= agreement) break;
    }
    return high;
  }

  const ThermalModel<Dim>& model_;
  TemperatureSteps<Dim> steps_;
  const std::vector<double>& density_;
  const ThermalLayer& layer_;
  int number_;
  double excess_, least_step_;
};

}  // namespace

/// Finds the pauses. With several passes a layer, theirs are the one that is sought: guessed from the layer
/// before and corrected until both agree.
template <int Dim>
double find_pauses(const ThermalModel<Dim>& model, HeatSolver<Dim>& solver, const SolveTolerance& tolerance,
                   const LayerDensities& densities, double limit, std::span<double> seconds) {
  std::vector<double> theta = model.start(), capacity_before = model.first_capacity();
  double welding = 0.0, guess = model.properties.pause;
  for (int number = 0; number < densities.count(); ++number) {
    ThermalLayer layer = model.layer(densities, number);
    welding += std::max(layer.mass, 0.0) / model.properties.rate;
    if (number + 1 == densities.count()) break;
    PauseSearch<Dim> search(model, solver, tolerance, densities.layer[number], layer, number,
                            limit - model.properties.ambient);
    const int rounds = model.properties.passes > 1 ? most_rounds : 1;
    std::vector<double> after;
    double found = 0.0;
    for (int round = 0; round < rounds; ++round) {
      after = theta;
      search.weld(capacity_before, guess, after);
      const std::vector<double> welded = after;
      found = search.rest(after);
      if (found < 0.0) {
        after = welded;
        if (model.properties.pause > 0.0) search.cool(model.properties.pause, after);
        break;
      }
      if (std::abs(found - guess) <= agreement * std::max(found, guess)) break;
      guess = 0.5 * (found + guess);
    }
    seconds[number] = found;
    guess = found < 0.0 ? model.properties.pause : found;
    theta = std::move(after);
    capacity_before = std::move(layer.capacity);
  }
  return welding;
}

FABSEQ_INSTANTIATE_FUNCTION(find_pauses);

}  // namespace fabseq
