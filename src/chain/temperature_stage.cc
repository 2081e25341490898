// SPDX-License-Identifier: MIT
#include "fabseq/base/mpi.h"
#include "fabseq/chain/part_temperature.h"
#include "fabseq/chain/stage.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace fabseq {

namespace {

/// Densities to the temperatures at which layers begin (docs/formulation.md 14). A row's adjoint belongs to
/// its owner's group: its steps follow each other, and so do not depend on who has which layers.
template <int Dim>
class TemperatureStage : public Stage<Dim> {
 public:
  /// Null without a block `thermal`.
  static std::unique_ptr<Stage<Dim>> make(StageContext<Dim>& context) {
    if (!context.model.settings.thermal) return nullptr;
    return std::make_unique<TemperatureStage>(context);
  }
  explicit TemperatureStage(StageContext<Dim>& context)
      : groups_(context.model.groups),
        temperature_(context.model, context.tolerance),
        standing_(context.model.part, context.model.settings.process.least_standing()) {}

  void forward(const StageInput& input, StageResults<Dim>& results) override {
    temperature_.simulation.set_tolerance(step_tolerance(input.tolerance));
    temperature_.simulation.take_only(input.region == SolverRegion::built ? &standing_ : nullptr);
    results.temperatures = temperature_.simulation.simulate(*results.densities);
    iterations_ = results.temperatures->iterations;
  }

  void pull_back(const StageResults<Dim>& state, const SolveTolerance& tolerance,
                 AdjointRowSpan<Dim> rows) override {
    bool any_shared = false;
    for (AdjointRow<Dim>* row : rows) {
      if (!row->shared) continue;
      any_shared = true;
      row->adjoint.temperatures.zeros_if_empty(state.densities->count());
      row->adjoint.temperatures.sum_at(groups_, row->owner);
    }
    const auto pull_back_own = [&] { this->pull_back_own(state, tolerance, rows); };
    // Rows that are not shared come from within a group.
    if (any_shared)
      groups_.run(pull_back_own);
    else
      pull_back_own();
  }
  Phase phase() const override { return Phase::heat; }
  void start_cold() override { temperature_.simulation.start_cold(); }
  void release_memory() override { temperature_.simulation.release_memory(); }
  void add_iterations(SolverIterations& iterations) const override { iterations.temperature = iterations_; }

 private:
  void pull_back_own(const StageResults<Dim>& state, const SolveTolerance& tolerance,
                     AdjointRowSpan<Dim> rows) {
    std::vector<TemperatureAdjoint> functionals;
    for (AdjointRow<Dim>* row : rows) {
      std::vector<double>& interpass = row->adjoint.temperatures.interpass;
      if (!row->own || interpass.empty()) continue;
      sum_in_place(groups_.domain(), std::span<double>(interpass));
      functionals.push_back({interpass, row->adjoint.temperatures.ends, &row->adjoint.densities, &row->sink});
    }
    temperature_.simulation.set_tolerance(step_tolerance(tolerance));
    temperature_.simulation.pull_back(*state.densities, functionals);
    for (AdjointRow<Dim>* row : rows)
      if (row->own) row->adjoint.temperatures.drop();
  }

  const LayerGroups& groups_;
  PartTemperature<Dim> temperature_;
  StandingElements<Dim> standing_;
  std::vector<int> iterations_;
};

/// Memory per node, measured for the sequence's solver (docs/developer/measuring.md): per lane or, on the
/// reference path, all in all.
constexpr double step_bytes_per_lane = 106.0, reference_step_bytes = 700.0;
/// Costs of a solve with one right-hand side on one core, per node; and of a step and its adjoint, in units
/// of a full block of layers. Measured on a V-shape of 125,000 nodes (docs/developer/measuring.md).
constexpr double seconds_per_node = 2.6e-7, reference_seconds_per_node = 2e-5, work_of_step = 0.03;
/// Where properties follow the temperature, times this: rounds of Newton's method, and an operator for each.
constexpr double curved = 1.8;

/// A simulation and one adjoint: one group steps for all, and each has all temperatures.
StageCost cost_of_temperature(const RunSize& size, SolverPath path, int groups, int lanes) {
  if (size.temperature_steps == 0.0) return {};
  const bool has_lanes = path == SolverPath::lanes;
  const double solves = 2.0 * (size.curved_heat ? curved : 1.0) * size.temperature_steps;
  return {
      .held = size.solid_nodes * size.temperature_steps * sizeof(double) * groups,
      .solving = size.solid_nodes * (has_lanes ? step_bytes_per_lane * lanes : reference_step_bytes) * groups,
      .work = 0.5 * work_of_step * solves,
      .seconds = solves * size.solid_nodes * (has_lanes ? seconds_per_node : reference_seconds_per_node) *
                 groups / size.ranks};
}

const RegisteredStage<TemperatureStage> temperature_stage{
    {"temperature", {&Results::densities}, {&Results::temperatures}}, cost_of_temperature};

}  // namespace

}  // namespace fabseq
