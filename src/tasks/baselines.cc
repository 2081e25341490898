// SPDX-License-Identifier: MIT
#include "fabseq/tasks/baselines.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/even_time.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/tilted_directions.h"
#include "fabseq/tasks/coarse_grid.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace fabseq {

namespace {

/// Tilt of the directions to try where the machine has no limit, degrees.
constexpr double usual_tilt = 60.0;
/// How closely directions are solved for that are only compared: to a tenth of a percent.
constexpr SolveTolerance for_comparison{.value = 1e-3, .reach = 1.0, .flow = 1e-3};
/// Directions that are tried on the grid of a run once all were on a coarser one.
constexpr std::size_t most_finalists = 3;
/// Seconds without a line on the terminal.
constexpr double longest_silence = 4.0;

/// Simulates, and judges by real layers where there are any.
template <int Dim>
SequenceReport simulated(const Setup<Dim>& setup, const Problem<Dim>& problem, PseudoTime<Dim> time,
                         const LayerModel<Dim>& layers, const BeadChecks<Dim>* beads, PhaseTimer& timer,
                         const SolveTolerance& tolerance) {
  Pipeline<Dim> pipeline(setup, std::make_unique<GivenSequence<Dim>>(std::move(time)), layers,
                         setup.config.solver.finest_tolerance(), timer);
  pipeline.set_tolerances(Tolerances::all(tolerance));
  const auto state = pipeline.run({}, 0.0, true);
  SequenceReport report = report_sequence(setup, problem, pipeline, state);
  if (beads) beads->judge(*state.time, state.densities->count(), report);
  return report;
}

template <int Dim>
SequenceReport simulated(const Setup<Dim>& setup, const Problem<Dim>& problem, PseudoTime<Dim> time,
                         const LayerModel<Dim>& layers, const BeadChecks<Dim>* beads, PhaseTimer& timer) {
  return simulated(setup, problem, std::move(time), layers, beads, timer,
                   setup.config.solver.tolerance_of_reports());
}

/// Mean of the layers by volume; none where their thickness is not defined.
std::optional<double> mean_thickness(const std::vector<LayerNumbers>& layers) {
  double sum = 0.0, volume = 0.0;
  for (const LayerNumbers& layer : layers) {
    if (!std::isfinite(layer.thickness) || !(layer.volume > 0.0)) continue;
    sum += layer.volume * layer.thickness;
    volume += layer.volume;
  }
  return sum > 0.0 ? std::optional(sum / volume) : std::nullopt;
}

/// Makes baselines in layers as thick as an optimized sequence's, on the grid of a run or on a coarser one.
template <int Dim>
class BaselineMaker {
 public:
  BaselineMaker(const Setup<Dim>& setup, const Problem<Dim>& problem, const SequenceNumbers& optimized,
                const BeadChecks<Dim>* beads, PhaseTimer& timer)
      : setup_(setup),
        problem_(problem),
        beads_(beads),
        thickness_(mean_thickness(optimized.layers)),
        used_layers_(optimized.used_layers()),
        timer_(timer) {}

  /// None if the planar baseline has as many layers.
  std::optional<Baseline> matched() const {
    const int count = count_for(planar_height(setup_.part, setup_.config.baseline.direction), used_layers_);
    if (count == setup_.baseline->count()) return std::nullopt;
    return Baseline{"baseline_matched", "planar, " + std::to_string(count) + " layers", "",
                    planar(setup_.config.baseline.direction, count, beads_)};
  }

  std::optional<Baseline> even() const {
    auto [time, height] = even_time(setup_.part);
    const int count = count_for(height, setup_.layers->planar_count(height));
    return Baseline{"baseline_even", "even layers", "even/",
                    simulated(setup_, problem_, std::move(time), *layers_of(count), beads_, timer_)};
  }

  std::optional<Baseline> tilted() const {
    Baseline result{"baseline_tilted", "", "tilted/", {}};
    if (const auto coarse = coarse_grid()) {
      const Problem<Dim> problem(coarse->setup(), setup_.config.optimizer.constraint_margin);
      result.tried = BaselineMaker(*this, coarse->setup(), problem).try_directions(result.tried_on);
      result.finalists = finalists_of(result.tried);
    } else {
      result.tried = try_directions(result.tried_on);
      settle_best(result.tried);
    }
    const auto& chosen_from = result.finalists.empty() ? result.tried : result.finalists;
    const TriedDirection& best = *std::min_element(chosen_from.begin(), chosen_from.end(), better);
    result.direction = best.direction;
    result.title = formatted("planar at %.3g degrees", best.tilt);
    result.numbers = planar(best.direction, beads_);
    print(formatted("  the best is tilted by %.3g degrees", best.tilt));
    return result;
  }

 private:
  /// The better class comes first.
  static bool better(const TriedDirection& a, const TriedDirection& b) {
    return std::pair(a.build_class, a.length) < std::pair(b.build_class, b.length);
  }

  std::unique_ptr<const LayerModel<Dim>> layers_of(int count) const {
    return make_layer_model({.count = count}, {}, setup_.part);
  }
  /// Number of layers for a height; `otherwise` where the optimized layers have no thickness.
  int count_for(double height, int otherwise) const {
    if (!thickness_) return otherwise;
    return static_cast<int>(std::clamp(std::round(height / *thickness_), 1.0, 1.0 * most_layers));
  }

  SequenceReport planar(const std::vector<double>& direction, int count, const BeadChecks<Dim>* beads) const {
    return simulated(setup_, problem_, planar_time(setup_.part, direction), *layers_of(count), beads, timer_);
  }
  SequenceReport planar(const std::vector<double>& direction, const BeadChecks<Dim>* beads) const {
    return planar(direction, count_along(direction), beads);
  }
  int count_along(const std::vector<double>& direction) const {
    const double height = planar_height(setup_.part, direction);
    return count_for(height, setup_.layers->planar_count(height));
  }

  /// Half the resolution; none where the part or its plate leave none.
  std::optional<CoarseGrid<Dim>> coarse_grid() const {
    try {
      return CoarseGrid<Dim>(setup_);
    } catch (const InputError&) {
      return std::nullopt;
    }
  }
  BaselineMaker(const BaselineMaker& fine, const Setup<Dim>& setup, const Problem<Dim>& problem)
      : setup_(setup),
        problem_(problem),
        thickness_(fine.thickness_),
        used_layers_(fine.used_layers_),
        timer_(fine.timer_) {}

  SolveTolerance closest() const { return setup_.config.solver.tolerance_of_reports(); }
  SolveTolerance coarsest() const {
    return closest().value < for_comparison.value ? for_comparison : closest();
  }

  /// All directions within the machine's tilt, solved for coarsely. Simulated layers are judged: real ones
  /// would take longer than their simulation.
  std::vector<TriedDirection> try_directions(std::vector<int>& elements) const {
    const double limit = setup_.config.tool.max_tilt;
    const auto directions = tilted_directions<Dim>(setup_.part.plate(), limit < 90.0 ? limit : usual_tilt);
    std::vector<TriedDirection> result;
    print("planar layers in " + std::to_string(directions.size()) + " directions, for comparison");
    double said = MPI_Wtime();
    for (const auto& [direction, tilt] : directions) {
      if (MPI_Wtime() - said > longest_silence) {
        print("  direction " + std::to_string(result.size() + 1) + " of " +
              std::to_string(directions.size()));
        said = MPI_Wtime();
      }
      result.push_back({{direction.begin(), direction.end()}, tilt});
      try_direction(result.back(), coarsest());
    }
    const Index<Dim>& of_grid = setup_.grid.domain().elements;
    elements.assign(of_grid.begin(), of_grid.end());
    return result;
  }

  void try_direction(TriedDirection& tried, const SolveTolerance& tolerance) const {
    stop_if_requested(setup_.world());
    const std::vector<double>& direction = tried.direction;
    const BeadChecks<Dim>* none = nullptr;
    const SequenceNumbers numbers = simulated(setup_, problem_, planar_time(setup_.part, direction),
                                              *layers_of(count_along(direction)), none, timer_, tolerance);
    tried.length = numbers.finished->deviation(any_measures_release(setup_.config.objective)).skin.rms;
    tried.build_class = numbers.verdict->build_class;
  }

  /// The best of those that were tried on the coarse grid, tried again.
  std::vector<TriedDirection> finalists_of(std::vector<TriedDirection> tried) const {
    std::ranges::stable_sort(tried, better);
    tried.resize(std::min(most_finalists, tried.size()));
    for (TriedDirection& finalist : tried) try_direction(finalist, closest());
    return tried;
  }

  /// Solves again for the best of those that were solved for coarsely, until it is one that was solved for as
  /// closely as reports are.
  void settle_best(std::vector<TriedDirection>& tried) const {
    std::vector<bool> settled(tried.size(), coarsest().value == closest().value);
    for (;;) {
      const auto best = std::min_element(tried.begin(), tried.end(), better);
      if (settled[best - tried.begin()]) return;
      try_direction(*best, closest());
      settled[best - tried.begin()] = true;
    }
  }

  const Setup<Dim>& setup_;
  const Problem<Dim>& problem_;
  const BeadChecks<Dim>* beads_ = nullptr;  ///< null: simulated layers are judged
  std::optional<double> thickness_;
  int used_layers_;
  PhaseTimer& timer_;
};

/// Adds one, or says why it is missing.
void add(std::vector<Baseline>& baselines, const char* block,
         const std::function<std::optional<Baseline>()>& make) {
  try {
    std::optional<Baseline> baseline = make();
    if (!baseline) return;
    if (baseline->group.empty()) {  // reports take memory
      SequenceReport numbers;
      static_cast<SequenceNumbers&>(numbers) = std::move(baseline->numbers);
      baseline->numbers = std::move(numbers);
    }
    baselines.push_back(std::move(*baseline));
  } catch (const NumericalError& error) {
    warn(std::string("no block ") + block + " in summary.json: " + error.what());
  }
}

}  // namespace

template <int Dim>
SequenceReport planar_baseline(const Setup<Dim>& setup, const Problem<Dim>& problem, PhaseTimer& timer) {
  const auto beads = make_bead_checks(setup);
  return simulated(setup, problem, planar_time(setup.part, setup.config.baseline.direction), *setup.baseline,
                   beads.get(), timer);
}

template <int Dim>
std::vector<Baseline> other_baselines(const Setup<Dim>& setup, const Problem<Dim>& problem,
                                      const SequenceNumbers& optimized, const BeadChecks<Dim>* beads,
                                      PhaseTimer& timer) {
  const BaselineMaker<Dim> maker(setup, problem, optimized, beads, timer);
  std::vector<Baseline> result;
  add(result, "baseline_matched", [&] { return maker.matched(); });
  if (setup.config.baseline.best_direction) add(result, "baseline_tilted", [&] { return maker.tilted(); });
  if (setup.config.baseline.even) add(result, "baseline_even", [&] { return maker.even(); });
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(planar_baseline);
FABSEQ_INSTANTIATE_FUNCTION(other_baselines);

}  // namespace fabseq
