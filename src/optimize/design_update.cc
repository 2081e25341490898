#include "fabseq/optimize/design_update.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

MmaSettings mma_settings(const OptimizerSettings& settings) {
  MmaSettings result;
  result.asymptote_initial = settings.asymptote_initial;
  result.asymptote_increase = settings.asymptote_increase;
  result.asymptote_decrease = settings.asymptote_decrease;
  result.asymptote_floor = settings.asymptote_floor;
  return result;
}

}  // namespace

DesignUpdate::DesignUpdate(MPI_Comm comm, const DesignSpace& space, std::size_t variables,
                           const OptimizerSettings& settings)
    : comm_(comm), space_(space), mma_(comm, variables, mma_settings(settings)) {}

StepReport DesignUpdate::update(std::vector<double>& design, const ProblemGradients& gradients,
                                double move_limit) {
  const std::size_t count = design.size();
  std::vector<double> unit(count), slope(count);
  for (std::size_t i = 0; i < count; ++i) {
    unit[i] = space_.to_unit(design[i]);
    slope[i] = space_.slope(design[i]);
  }
  std::vector<double> objective = gradients.objective;
  std::vector<std::vector<double>> constraints = gradients.constraints;
  for (std::size_t i = 0; i < count; ++i) objective[i] *= slope[i];
  for (auto& row : constraints)
    for (std::size_t i = 0; i < count; ++i) row[i] *= slope[i];

  const std::vector<double> lower(count, 0.0), upper(count, 1.0), before = unit;
  StepReport report;
  report.mma = mma_.update(unit, objective, gradients.constraint_values, constraints, lower, upper,
                           move_limit, MmaRows::constraints(static_cast<int>(constraints.size())));
  for (std::size_t i = 0; i < count; ++i) {
    report.change = std::max(report.change, std::abs(unit[i] - before[i]));
    design[i] = space_.from_unit(unit[i]);
  }
  report.change = max(comm_, report.change);
  return report;
}

void DesignUpdate::save(CheckpointState& state) const {
  const MmaState& mma = mma_.state();
  state.set_scalar("optimizer/updates", mma.iteration);
  state.set_field("optimizer/low", mma.low);
  state.set_field("optimizer/upp", mma.upp);
  state.set_field("optimizer/previous", mma.previous);
  state.set_field("optimizer/before_previous", mma.before_previous);
}

void DesignUpdate::restore(const CheckpointState& state) {
  mma_.restore({state.integer("optimizer/updates"), state.field("optimizer/low"),
                state.field("optimizer/upp"), state.field("optimizer/previous"),
                state.field("optimizer/before_previous")});
}

}  // namespace fabseq
