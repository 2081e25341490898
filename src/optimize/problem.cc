// SPDX-License-Identifier: MIT
#include "fabseq/optimize/problem.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/session.h"
#include "fabseq/model/run_size.h"
#include "fabseq/process/inherent_strain.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fabseq {

namespace {

/// A functional whose square is a smaller share of the term stays in the rest: it vanishes by symmetry, as a
/// rule, and would cost an adjoint for nothing.
constexpr double least_share = 1e-6;
/// Share of the term: functionals that together hold less do not pay for their adjoints, unless asked for
/// (docs/formulation.md 9).
constexpr double worthwhile_share = 0.5;
/// Nothing is gained where a term has fallen below this share of its first value, a millionth in
/// displacements.
constexpr double negligible_share = 1e-12;
/// A term that begins with no more than rounding is scaled as if it began with this share of its size, a
/// hundredth in displacements.
constexpr double usual_share = 1e-4;

}  // namespace

template <int Dim>
Problem<Dim>::Problem(const Model<Dim>& model, double constraint_margin)
    : terms_(model.settings.objective),
      margin_(constraint_margin),
      responses_(model.objective),
      limits_(model.settings.constraints.size()) {
  responses_.insert(responses_.end(), model.constraints.begin(), model.constraints.end());
  for (const Term& term : model.settings.constraints) has_check_.push_back(!term.type->exact_check.empty());
  for (const std::vector<Term>* list : {&model.settings.objective, &model.settings.constraints})
    for (const Term& term : *list) types_.push_back(term.type->name);
  configured_ = responses_.size();
  const double displacement = largest_strain(model.settings.material) * model.part.longest_edge();
  for (std::size_t i = 0; i < terms_.size(); ++i)
    sizes_.push_back(responses_[i]->size() > 0.0 || !responses_[i]->uses_displacements()
                         ? responses_[i]->size()
                         : displacement * displacement);
  add_largest();
  if (!largest_) add_functionals(model.settings);
}

/// Bounds of a constraint's components, as far as they have adapted.
template <int Dim>
std::vector<ConstraintRow> Problem<Dim>::bounds_of(std::size_t constraint, double margin) const {
  std::vector<ConstraintRow> result = responses_[terms_.size() + constraint]->rows(margin);
  for (ConstraintRow& row : result)
    if (row.adapts) row.bound *= limits_.factor(constraint);
  return result;
}

template <int Dim>
bool Problem<Dim>::adapts() const {
  for (std::size_t i = 0; i < has_check_.size(); ++i)
    for (const ConstraintRow& row : bounds_of(i, 1.0))
      if (row.adapts) return true;
  return false;
}

template <int Dim>
void Problem<Dim>::adapt(const ProblemValues& values, std::span<const double> shares, bool may_widen) {
  for (std::size_t i = 0; i < shares.size(); ++i)
    for (const ConstraintRow& row : bounds_of(i, 1.0)) {
      if (!row.adapts) continue;
      double worst = -std::numeric_limits<double>::max();
      for (const double value : values.constraints[i]) worst = std::max(worst, row.violation(value));
      limits_.adapt(i, worst, shares[i], may_widen);
    }
}

template <int Dim>
void Problem<Dim>::add_largest() {
  for (std::size_t i = 0; i < terms_.size() && !largest_; ++i) {
    if (terms_[i].weight == 0.0) continue;
    auto values = responses_[i]->largest_of();
    if (!values) continue;
    largest_ = i;
    responses_.push_back(std::move(values));
    types_.push_back(types_[i]);
  }
}

/// Terms without weight get none: their rows would have no meaning.
template <int Dim>
void Problem<Dim>::add_functionals(const ModelSettings& settings) {
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (terms_[i].weight == 0.0) continue;
    auto functionals = responses_[i]->squares(terms_[i].scaling);
    if (!functionals || !takes_squares(settings, *functionals)) continue;
    squares_.push_back({i, responses_.size(), functionals->complete, functionals->asked_for});
    responses_.push_back(std::move(functionals->functionals));
    types_.emplace_back("least_squares");
  }
}

/// Which functionals the optimizer gets as residuals at a design.
template <int Dim>
std::vector<int> Problem<Dim>::residuals_of(const Squares& squares, const ProblemValues& values) const {
  const std::vector<double>& functionals = values.functionals[squares.term];
  const double whole = values.objective[squares.term][0];
  const double total = std::inner_product(functionals.begin(), functionals.end(), functionals.begin(), 0.0);
  std::vector<int> result;
  if (!squares.complete && !squares.always && total < worthwhile_share * whole) return result;
  for (std::size_t k = 0; k < functionals.size(); ++k)
    if (squares.complete || functionals[k] * functionals[k] > least_share * whole)
      result.push_back(static_cast<int>(k));
  return result;
}

template <int Dim>
bool Problem<Dim>::begins_with_rounding(std::size_t term) const {
  return first_values_[term] <= negligible_share * sizes_[term];
}

/// The value that a term with scaling `first` is divided by; 0: it is not scaled.
template <int Dim>
double Problem<Dim>::first_value(std::size_t term) const {
  return begins_with_rounding(term) ? usual_share * sizes_[term] : first_values_[term];
}

/// The value that a term with scaling `current` is divided by. What has fallen to the errors of the solves is
/// not enlarged further: the optimizer would be given noise.
template <int Dim>
double Problem<Dim>::current_value(std::size_t term, double value) const {
  return std::max(value,
                  begins_with_rounding(term) ? first_value(term) : negligible_share * first_value(term));
}

/// Factor of each term: its value becomes `normalize` at the first iteration, or at every one.
template <int Dim>
std::vector<double> Problem<Dim>::term_factors(const std::vector<std::vector<double>>& objective) const {
  std::vector<double> factors;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const double value =
        terms_[i].scaling == TermScaling::current ? current_value(i, objective[i][0]) : first_value(i);
    factors.push_back(value > 0.0 ? terms_[i].normalize / value : 1.0);
  }
  return factors;
}

template <int Dim>
ProblemValues Problem<Dim>::evaluate(Pipeline<Dim>& pipeline, const StageResults<Dim>& state) {
  auto all = pipeline.values(responses_and_functionals(), state);
  for (std::size_t r = 0; r < all.size(); ++r)
    for (std::size_t c = 0; c < all[r].size(); ++c)
      if (!std::isfinite(all[r][c]))
        throw NumericalError(component_name(r, c) + " (" + types_[r] + ") is not finite");
  ProblemValues result;
  const auto split = all.begin() + static_cast<std::ptrdiff_t>(terms_.size());
  result.objective.assign(all.begin(), split);
  const auto end = all.begin() + static_cast<std::ptrdiff_t>(configured_);
  result.constraints.assign(split, end);
  result.functionals.resize(terms_.size());
  for (const Squares& squares : squares_) result.functionals[squares.term] = all[squares.response];
  if (largest_) result.scenarios = all[configured_];
  if (adapts()) result.limit_factors = limits_.factors();
  if (first_values_.empty()) {
    for (const auto& value : result.objective) first_values_.push_back(value[0]);
    warn_of_rounding();
  }
  const std::vector<double> factors = term_factors(result.objective);
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const double value = result.objective[i][0];
    result.scaled.push_back(terms_[i].weight * factors[i] * value);
    // A term scaled by its current value is normalize * ln(value) in disguise.
    result.merit +=
        terms_[i].scaling == TermScaling::current
            ? terms_[i].weight * terms_[i].normalize * std::log(std::max(current_value(i, value), 1e-300))
            : result.scaled.back();
  }
  result.worst_constraint = result.constraints.empty() ? 0.0 : -std::numeric_limits<double>::max();
  result.worst_unchecked = -std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < result.constraints.size(); ++i)
    for (const ConstraintRow& row : bounds_of(i, 1.0))
      for (const double value : result.constraints[i]) {
        result.worst_constraint = std::max(result.worst_constraint, row.violation(value));
        if (!has_check_[i]) result.worst_unchecked = std::max(result.worst_unchecked, row.violation(value));
      }
  return result;
}

template <int Dim>
void Problem<Dim>::warn_of_rounding() const {
  for (std::size_t i = 0; i < terms_.size(); ++i)
    if (terms_[i].weight != 0.0 && sizes_[i] > 0.0 && begins_with_rounding(i))
      warn(formatted(
          "/objective/%zu: %s begins at %.2g, which is 0 but for rounding: it is scaled as if it began "
          "at %.2g",
          terms_[i].position, types_[i].c_str(), first_values_[i], first_value(i)));
}

/// The weighted terms but for one that is the largest of several; of a sum of squares what is not in the
/// residuals, J - sum r_k^2.
template <int Dim>
GradientRow Problem<Dim>::objective_row(const ProblemValues& values,
                                        const std::vector<double>& factors) const {
  GradientRow row;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    // What has no rest would cost an adjoint of rounding.
    const bool has_rest = std::none_of(squares_.begin(), squares_.end(), [i](const Squares& squares) {
      return squares.complete && squares.term == i;
    });
    if (has_rest && largest_ != i) row.push_back({static_cast<int>(i), 0, terms_[i].weight * factors[i]});
  }
  for (const Squares& squares : squares_) {
    if (squares.complete) continue;
    const double weight = terms_[squares.term].weight * factors[squares.term];
    for (const int k : residuals_of(squares, values))
      row.push_back(
          {static_cast<int>(squares.response), k, -2.0 * weight * values.functionals[squares.term][k]});
  }
  return row;
}

template <int Dim>
ProblemGradients Problem<Dim>::gradients(Pipeline<Dim>& pipeline, const StageResults<Dim>& state,
                                         const ProblemValues& values) const {
  // One row for the whole objective, one for each constrained component, which its upper and lower bound
  // share, and one for each residual.
  const std::vector<double> factors = term_factors(values.objective);
  std::vector<GradientRow> rows = {objective_row(values, factors)};
  std::vector<std::size_t> first_row;
  for (std::size_t i = 0; i < values.constraints.size(); ++i) {
    first_row.push_back(rows.size());
    for (std::size_t c = 0; c < values.constraints[i].size(); ++c)
      rows.push_back({{static_cast<int>(terms_.size() + i), static_cast<int>(c), 1.0}});
  }
  ProblemGradients result;
  std::size_t next_row = rows.size();
  for (std::size_t c = 0; c < values.scenarios.size(); ++c) {
    const double scale = terms_[*largest_].weight * factors[*largest_];
    result.largest.push_back({scale * values.scenarios[c], {}});
    rows.push_back({{static_cast<int>(configured_), static_cast<int>(c), scale}});
  }
  for (const Squares& squares : squares_) {
    const double scale = std::sqrt(terms_[squares.term].weight * factors[squares.term]);
    for (const int k : residuals_of(squares, values)) {
      result.residuals.push_back({scale * values.functionals[squares.term][k], {}});
      rows.push_back({{static_cast<int>(squares.response), k, scale}});
    }
  }
  auto gradients = pipeline.gradients(responses_and_functionals(), state, rows);

  result.objective = std::move(gradients[0]);
  for (std::size_t i = 0; i < values.constraints.size(); ++i) {
    const std::vector<ConstraintRow> bounds = bounds_of(i, margin_);
    for (std::size_t c = 0; c < values.constraints[i].size(); ++c)
      for (const ConstraintRow& row : bounds) {
        const double value = values.constraints[i][c];
        result.constraints.push_back({row.violation(value), gradients[first_row[i] + c]});
        Design& gradient = result.constraints.back().gradient;
        for (auto* entries : {&gradient.field, &gradient.layer_variables})
          for (double& entry : *entries) entry *= row.slope(value);
      }
  }
  for (auto* list : {&result.largest, &result.residuals})
    for (ProblemRow& row : *list) row.gradient = std::move(gradients[next_row++]);
  return result;
}

template <int Dim>
double Problem<Dim>::share_left(const ProblemValues& values) const {
  double share = 1.0;
  for (std::size_t i = 0; i < terms_.size(); ++i)
    if (terms_[i].weight != 0.0 && responses_[i]->uses_displacements() && first_values_[i] > 0.0 &&
        !begins_with_rounding(i))
      share = std::min(share, std::max(0.0, values.objective[i][0] / first_values_[i]));
  return share;
}

template <int Dim>
double Problem<Dim>::merit_unit() const {
  double unit = 0.0;
  for (const Term& term : terms_) unit += term.weight * term.normalize;
  return unit;
}

template <int Dim>
void Problem<Dim>::save(CheckpointState& state) const {
  if (!first_values_.empty()) state.set_array("problem/first_values", first_values_);
  limits_.save(state);
}

template <int Dim>
void Problem<Dim>::restore(const CheckpointState& state) {
  if (state.has_array("problem/first_values")) first_values_ = state.array("problem/first_values");
  limits_.restore(state);
}

template <int Dim>
std::string Problem<Dim>::component_name(std::size_t response, std::size_t component) const {
  if (response < terms_.size()) return "objective_" + std::to_string(response);
  for (const Squares& squares : squares_)
    if (squares.response == response)
      return "objective_" + std::to_string(squares.term) + "_functional_" + std::to_string(component);
  if (largest_ && response == configured_)
    return "objective_" + std::to_string(*largest_) + "_scenario_" + std::to_string(component);
  return "constraint_" + std::to_string(response - terms_.size()) + "_" + std::to_string(component);
}

template <int Dim>
std::vector<NamedValue> Problem<Dim>::describe(const std::vector<std::vector<double>>& values) const {
  std::vector<NamedValue> result;
  for (std::size_t r = 0; r < values.size(); ++r)
    for (std::size_t c = 0; c < values[r].size(); ++c)
      result.push_back({component_name(r, c), types_[r], values[r][c]});
  return result;
}

FABSEQ_INSTANTIATE_CLASS(Problem);

}  // namespace fabseq
