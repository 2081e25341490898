// SPDX-License-Identifier: MIT
#include "fabseq/optimize/design_update.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

DesignUpdate::DesignUpdate(MPI_Comm comm, const DesignSpace& space, bool field_is_fixed,
                           LayerVariables layer_variables, const Design& design, const MmaSettings& settings)
    : comm_(comm),
      space_(space),
      field_is_fixed_(field_is_fixed),
      layer_variables_(std::move(layer_variables)),
      field_size_(field_is_fixed ? 0 : design.field.size()),
      mma_(comm, field_size_ + (has_layer_variables() ? layer_variable_count() : 0), settings) {}

std::vector<double> DesignUpdate::to_variables(const Design& design) const {
  std::vector<double> result;
  for (std::size_t i = 0; i < field_size_; ++i) result.push_back(space_.of(i).to_unit(design.field[i]));
  if (has_layer_variables())
    result.insert(result.end(), design.layer_variables.begin(), design.layer_variables.end());
  return result;
}

std::vector<double> DesignUpdate::gradient_of_variables(Design gradient, const Design& design) const {
  std::vector<double> result = std::move(gradient.field);
  result.resize(field_size_);
  for (std::size_t i = 0; i < field_size_; ++i) result[i] *= space_.of(i).slope(design.field[i]);
  if (has_layer_variables())
    result.insert(result.end(), gradient.layer_variables.begin(), gradient.layer_variables.end());
  return result;
}

StepReport DesignUpdate::update(Design& design, ProblemGradients gradients, double move_limit) {
  const std::vector<double> before = to_variables(design);
  std::vector<double> now = before, lower(before.size(), 0.0), upper(before.size(), 1.0);
  for (std::size_t i = field_size_; i < before.size(); ++i) {
    const std::size_t number = i - field_size_;
    lower[i] = std::max(layer_variables_.lower[number], before[i] - layer_variables_.reach);
    upper[i] = std::min(layer_variables_.upper[number], before[i] + layer_variables_.reach);
  }
  MmaRows kinds;
  kinds.add_constraints(gradients.constraints.size());
  kinds.add_largest_of(gradients.largest.size());
  kinds.add_residuals(gradients.residuals.size());
  std::vector<double> values;
  std::vector<std::vector<double>> rows;
  for (auto* list : {&gradients.constraints, &gradients.largest, &gradients.residuals})
    for (ProblemRow& row : *list) {
      values.push_back(row.value);
      rows.push_back(gradient_of_variables(std::move(row.gradient), design));
      if (list != &gradients.residuals) continue;
      // As a pair +r, -r, of which one is its absolute value.
      values.push_back(-row.value);
      rows.push_back(rows.back());
      for (double& entry : rows.back()) entry = -entry;
    }
  StepReport report;
  report.mma = mma_.update(now, gradient_of_variables(std::move(gradients.objective), design), values, rows,
                           lower, upper, move_limit, kinds);
  for (std::size_t i = 0; i < now.size(); ++i)
    report.change = std::max(report.change, std::abs(now[i] - before[i]) / (upper[i] - lower[i]));
  report.change = max(comm_, report.change);
  for (std::size_t i = 0; i < field_size_; ++i) design.field[i] = space_.of(i).from_unit(now[i]);
  if (has_layer_variables())
    std::copy(now.begin() + static_cast<std::ptrdiff_t>(field_size_), now.end(),
              design.layer_variables.begin());
  broadcast(comm_, design.layer_variables);
  return report;
}

/// The entries of the layers' variables as an array of their own.
void DesignUpdate::save_vector(CheckpointState& state, const std::string& name,
                               const std::vector<double>& values) const {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(field_size_);
  if (!field_is_fixed_) state.set_field("optimizer/" + name, {values.begin(), middle});
  if (layer_variable_count() == 0) return;
  std::vector<double> of_layers(middle, values.end());
  of_layers.resize(layer_variable_count());
  broadcast(comm_, of_layers);
  state.set_array("optimizer/" + layer_variables_.name + "_" + name, std::move(of_layers));
}

std::vector<double> DesignUpdate::restored_vector(const CheckpointState& state,
                                                  const std::string& name) const {
  std::vector<double> values;
  if (!field_is_fixed_) values = state.field("optimizer/" + name);
  if (layer_variable_count() == 0) return values;
  const std::vector<double>& of_layers = state.array("optimizer/" + layer_variables_.name + "_" + name);
  if (has_layer_variables()) values.insert(values.end(), of_layers.begin(), of_layers.end());
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
