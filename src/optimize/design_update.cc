#include "fabseq/optimize/design_update.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Those of field and time points, as they follow each other in a rank's variables.
std::size_t variable_count(MPI_Comm comm, const Design& design) {
  return design.field.size() + (rank_of(comm) == 0 ? design.time_points.size() : 0);
}

}  // namespace

DesignUpdate::DesignUpdate(MPI_Comm comm, const DesignSpace& space, const Design& design,
                           const OptimizerSettings& settings)
    : comm_(comm),
      space_(space),
      field_size_(design.field.size()),
      time_point_count_(design.time_points.size()),
      mma_(comm, variable_count(comm, design), mma_settings(settings)) {}

bool DesignUpdate::has_time_points() const { return time_point_count_ > 0 && rank_of(comm_) == 0; }

std::vector<double> DesignUpdate::to_variables(const Design& design) const {
  std::vector<double> result;
  for (const double value : design.field) result.push_back(space_.to_unit(value));
  if (has_time_points()) result.insert(result.end(), design.time_points.begin(), design.time_points.end());
  return result;
}

std::vector<double> DesignUpdate::gradient_of_variables(const Design& gradient, const Design& design) const {
  std::vector<double> result = gradient.field;
  for (std::size_t i = 0; i < field_size_; ++i) result[i] *= space_.slope(design.field[i]);
  if (has_time_points())
    result.insert(result.end(), gradient.time_points.begin(), gradient.time_points.end());
  return result;
}

/// Each as a pair +r, -r, of which one is its absolute value.
void DesignUpdate::add_residuals(const ProblemGradients& gradients, const Design& design, MmaRows& kinds,
                                 std::vector<double>& values, std::vector<std::vector<double>>& rows) const {
  kinds.add_residuals(static_cast<int>(gradients.residuals.size()));
  for (std::size_t k = 0; k < gradients.residuals.size(); ++k) {
    const std::vector<double> gradient = gradient_of_variables(gradients.residuals[k], design);
    for (const double sign : {1.0, -1.0}) {
      values.push_back(sign * gradients.residual_values[k]);
      std::vector<double>& row = rows.emplace_back(gradient);
      for (double& entry : row) entry *= sign;
    }
  }
}

StepReport DesignUpdate::update(Design& design, const ProblemGradients& gradients, double move_limit) {
  const std::vector<double> before = to_variables(design);
  std::vector<double> now = before, lower(before.size(), 0.0), upper(before.size(), 1.0);
  // Time points shall not overtake each other.
  const double layer = 1.0 / (static_cast<double>(time_point_count_) + 1.0);
  for (std::size_t i = field_size_; i < before.size(); ++i) {
    lower[i] = std::max(0.0, before[i] - layer);
    upper[i] = std::min(1.0, before[i] + layer);
  }
  MmaRows kinds = MmaRows::constraints(static_cast<int>(gradients.constraints.size()));
  std::vector<double> values = gradients.constraint_values;
  std::vector<std::vector<double>> rows;
  for (const Design& row : gradients.constraints) rows.push_back(gradient_of_variables(row, design));
  add_residuals(gradients, design, kinds, values, rows);
  StepReport report;
  report.mma = mma_.update(now, gradient_of_variables(gradients.objective, design), values, rows, lower,
                           upper, move_limit, kinds);
  for (std::size_t i = 0; i < now.size(); ++i)
    report.change = std::max(report.change, std::abs(now[i] - before[i]) / (upper[i] - lower[i]));
  report.change = max(comm_, report.change);
  for (std::size_t i = 0; i < field_size_; ++i) design.field[i] = space_.from_unit(now[i]);
  if (has_time_points())
    std::copy(now.begin() + static_cast<std::ptrdiff_t>(field_size_), now.end(), design.time_points.begin());
  broadcast(comm_, design.time_points);
  return report;
}

/// The time points' entries as an array of their own.
void DesignUpdate::save_vector(CheckpointState& state, const std::string& name,
                               const std::vector<double>& values) const {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(field_size_);
  state.set_field("optimizer/" + name, {values.begin(), middle});
  if (time_point_count_ == 0) return;
  std::vector<double> of_time_points(middle, values.end());
  of_time_points.resize(time_point_count_);
  broadcast(comm_, of_time_points);
  state.set_array("optimizer/time_points_" + name, std::move(of_time_points));
}

std::vector<double> DesignUpdate::restored_vector(const CheckpointState& state,
                                                  const std::string& name) const {
  std::vector<double> values = state.field("optimizer/" + name);
  if (time_point_count_ == 0) return values;
  const std::vector<double>& of_time_points = state.array("optimizer/time_points_" + name);
  if (has_time_points()) values.insert(values.end(), of_time_points.begin(), of_time_points.end());
  return values;
}

void DesignUpdate::save(CheckpointState& state) const {
  const MmaState& mma = mma_.state();
  state.set_scalar("optimizer/updates", mma.iteration);
  save_vector(state, "low", mma.low);
  save_vector(state, "upp", mma.upp);
  save_vector(state, "previous", mma.previous);
  save_vector(state, "before_previous", mma.before_previous);
}

void DesignUpdate::restore(const CheckpointState& state) {
  mma_.restore({state.integer("optimizer/updates"), restored_vector(state, "low"),
                restored_vector(state, "upp"), restored_vector(state, "previous"),
                restored_vector(state, "before_previous")});
}

}  // namespace fabseq
