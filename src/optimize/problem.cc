#include "fabseq/optimize/problem.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

double normalized(double normalize, double value) { return value > 0.0 ? normalize / value : 1.0; }

}  // namespace

template <int Dim>
Problem<Dim>::Problem(const Setup<Dim>& setup)
    : terms_(setup.config.objective), margin_(setup.config.optimizer.constraint_margin) {
  const ResponseContext<Dim> context = setup.context();
  for (const ObjectiveTerm& term : terms_) responses_.push_back(make_objective<Dim>(term, context));
  for (const ConstraintTerm& term : setup.config.constraints)
    responses_.push_back(make_constraint<Dim>(term, context));
}

/// Factor of each term: its value becomes `normalize` at the first iteration, or at every one.
template <int Dim>
std::vector<double> Problem<Dim>::term_factors(const std::vector<std::vector<double>>& objective) const {
  std::vector<double> factors;
  for (std::size_t i = 0; i < terms_.size(); ++i)
    factors.push_back(normalized(
        terms_[i].normalize, terms_[i].scaling == TermScaling::current ? objective[i][0] : first_values_[i]));
  return factors;
}

template <int Dim>
ProblemValues Problem<Dim>::evaluate(Pipeline<Dim>& pipeline, const PipelineState<Dim>& state) {
  auto all = pipeline.values(responses_, state);
  for (std::size_t r = 0; r < all.size(); ++r)
    for (std::size_t c = 0; c < all[r].size(); ++c)
      if (!std::isfinite(all[r][c]))
        throw NumericalError(component_name(r, c) + " (" + responses_[r]->type() + ") is not finite");
  ProblemValues result;
  const auto split = all.begin() + static_cast<std::ptrdiff_t>(terms_.size());
  result.objective.assign(all.begin(), split);
  result.constraints.assign(split, all.end());
  if (first_values_.empty())
    for (const auto& value : result.objective) first_values_.push_back(value[0]);

  const std::vector<double> factors = term_factors(result.objective);
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const double value = result.objective[i][0];
    result.scaled.push_back(terms_[i].weight * factors[i] * value);
    // A term scaled by its current value is normalize * ln(value) in disguise.
    result.merit += terms_[i].scaling == TermScaling::current
                        ? terms_[i].weight * terms_[i].normalize * std::log(std::max(value, 1e-300))
                        : result.scaled.back();
  }
  result.worst_constraint = result.constraints.empty() ? 0.0 : -std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < result.constraints.size(); ++i) {
    const auto& values = result.constraints[i];
    for (const ConstraintRow& row : responses_[terms_.size() + i]->rows(static_cast<int>(values.size()), 1.0))
      result.worst_constraint = std::max(result.worst_constraint, row.violation(values[row.component]));
  }
  return result;
}

template <int Dim>
ProblemGradients Problem<Dim>::gradients(Pipeline<Dim>& pipeline, const PipelineState<Dim>& state,
                                         const ProblemValues& values) const {
  // One row for the whole objective and one for each constrained component, which its upper and lower bound
  // share.
  const std::vector<double> factors = term_factors(values.objective);
  std::vector<GradientRow> rows(1);
  for (std::size_t i = 0; i < terms_.size(); ++i)
    rows[0].push_back({static_cast<int>(i), 0, terms_[i].weight * factors[i]});
  std::vector<std::size_t> first_row;
  for (std::size_t i = 0; i < values.constraints.size(); ++i) {
    first_row.push_back(rows.size());
    for (std::size_t c = 0; c < values.constraints[i].size(); ++c)
      rows.push_back({{static_cast<int>(terms_.size() + i), static_cast<int>(c), 1.0}});
  }
  auto gradients = pipeline.gradients(responses_, state, rows);

  ProblemGradients result;
  result.objective = std::move(gradients[0]);
  for (std::size_t i = 0; i < values.constraints.size(); ++i) {
    const auto& components = values.constraints[i];
    for (const ConstraintRow& row :
         responses_[terms_.size() + i]->rows(static_cast<int>(components.size()), margin_)) {
      result.constraint_values.push_back(row.violation(components[row.component]));
      Design& gradient = result.constraints.emplace_back(gradients[first_row[i] + row.component]);
      for (auto* entries : {&gradient.field, &gradient.layer_variables})
        for (double& entry : *entries) entry *= row.sign / row.scale;
    }
  }
  return result;
}

template <int Dim>
void Problem<Dim>::save(CheckpointState& state) const {
  if (!first_values_.empty()) state.set_array("problem/first_values", first_values_);
}

template <int Dim>
void Problem<Dim>::restore(const CheckpointState& state) {
  if (state.has_array("problem/first_values")) first_values_ = state.array("problem/first_values");
}

template <int Dim>
std::string Problem<Dim>::component_name(std::size_t response, std::size_t component) const {
  if (response < terms_.size()) return "objective_" + std::to_string(response);
  return "constraint_" + std::to_string(response - terms_.size()) + "_" + std::to_string(component);
}

template <int Dim>
Json Problem<Dim>::describe(const std::vector<std::vector<double>>& values) const {
  Json result = Json::array();
  for (std::size_t r = 0; r < values.size(); ++r)
    for (std::size_t c = 0; c < values[r].size(); ++c)
      result.append(Json::object(
          {{"name", component_name(r, c)}, {"type", responses_[r]->type()}, {"value", values[r][c]}}));
  return result;
}

template class Problem<2>;
template class Problem<3>;

}  // namespace fabseq
