// SPDX-License-Identifier: MIT
/// \file
/// Responses scaled and stacked into an optimization problem (docs/formulation.md 9).
#pragma once

#include "fabseq/chain/pipeline.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/optimize/adaptive_limits.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// A function of the design, by its value and its gradient.
struct ProblemRow {
  double value = 0.0;
  Design gradient;
};

/// What the optimizer is given at a design.
struct ProblemGradients {
  Design objective;  ///< gradient of the scaled objective less the residuals' squares and the largest
  std::vector<ProblemRow> constraints;  ///< f_i <= 0
  std::vector<ProblemRow> residuals;    ///< s r_k of what counts: their squares are part of the objective
  std::vector<ProblemRow> largest;      ///< the largest of them is part of the scaled objective
};

/// Values of all responses at a design; the same on all ranks.
struct ProblemValues {
  std::vector<std::vector<double>> objective;    ///< raw value of each term (one component)
  std::vector<std::vector<double>> constraints;  ///< left-hand sides, as the user reads them
  std::vector<std::vector<double>>
      functionals;  ///< r_k of each term handed over as a sum of squares, else none
  std::vector<double>
      limit_factors;  ///< of constraints, what their limits have been multiplied by; empty: none adapts
  std::vector<double> scenarios;  ///< J(u_s) of the term that is the largest of these; empty: there is none
  std::vector<double> scaled;     ///< weight * factor * raw value of each term
  double merit = 0.0;             ///< what the optimizer descends: comparable between iterations
  double worst_constraint =
      0.0;  ///< largest relative violation, negative when all are satisfied; 0 without any
  double worst_unchecked =
      0.0;  ///< the same of constraints without an exact check (ResponseTraits::exact_check)
};

/// A component of a response, by name, with the config's name of the response's type.
struct NamedValue {
  std::string name, type;
  double value = 0.0;
};

/// The objective terms and constraints of a model. Knows weights, scaling and margins, and nothing of what
/// is measured.
template <int Dim>
class Problem {
 public:
  /// `constraint_margin`: part of the width of each allowed range that the optimizer gets.
  Problem(const Model<Dim>& model, double constraint_margin);

  /// What the config lists.
  Responses<Dim> responses() const { return std::span(responses_).first(configured_); }
  /// The same and after them what the optimizer gets in place of a term: the functionals of a sum of squares,
  /// the values of which it is the largest.
  Responses<Dim> responses_and_functionals() const { return responses_; }
  /// Names of their types in the config; "least_squares" of functionals.
  const std::vector<std::string>& types() const { return types_; }
  /// Index in responses() of the first constraint; the terms of the objective come before it.
  std::size_t objective_count() const { return terms_.size(); }

  /// Values at a state of the pipeline; the first call fixes the factors of terms scaled by `first`.
  /// Collective.
  ProblemValues evaluate(Pipeline<Dim>& pipeline, const StageResults<Dim>& state);
  /// Gradients at the state of the last evaluate(). Collective.
  ProblemGradients gradients(Pipeline<Dim>& pipeline, const StageResults<Dim>& state,
                             const ProblemValues& values) const;

  /// Whether any constraint has a limit that adapts.
  bool adapts() const;
  /// Adapts the limits of constraints to what the exact checks find at the design of the last evaluate()
  /// (docs/developer/repair.md 13.2). `shares`: of the part, beyond the limit of each constraint; those of
  /// constraints whose limit is given are not looked at. `may_widen`: AdaptiveLimits::adapt(). Not
  /// collective; the same on all ranks.
  void adapt(const ProblemValues& values, std::span<const double> shares, bool may_widen);

  /// The smallest share of its first value that is left of a term of the objective that depends on
  /// displacements, at most 1; 1 without such terms.
  double share_left(const ProblemValues& values) const;

  /// What the terms' contributions to the merit are scaled to, all together.
  double merit_unit() const;

  /// The values of the first evaluate(), by which terms are scaled, and limits that have adapted.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

  /// Every component of responses(), as in evaluation.json: objective_0, constraint_0_0, ...
  std::vector<NamedValue> describe(const std::vector<std::vector<double>>& values) const;
  /// The same name for a component of responses_and_functionals(); functionals are objective_0_functional_0,
  /// ..., values of scenarios objective_0_scenario_0, ...
  std::string component_name(std::size_t response, std::size_t component) const;

 private:
  /// The functionals of a term that the optimizer gets as a sum of squares.
  struct Squares {
    std::size_t term = 0;      ///< index in terms_
    std::size_t response = 0;  ///< of the functionals, index in responses_
    bool complete = false;     ///< the squares are all of the term
    bool always = false;       ///< residuals whatever their share of the term
  };

  std::vector<ConstraintRow> bounds_of(std::size_t constraint, double margin) const;
  void add_largest();
  void add_functionals(const ModelSettings& settings);
  std::vector<int> residuals_of(const Squares& squares, const ProblemValues& values) const;
  bool begins_with_rounding(std::size_t term) const;
  double first_value(std::size_t term) const;
  double current_value(std::size_t term, double value) const;
  void warn_of_rounding() const;
  std::vector<double> term_factors(const std::vector<std::vector<double>>& objective) const;
  GradientRow objective_row(const ProblemValues& values, const std::vector<double>& factors) const;

  std::vector<Term> terms_;
  double margin_;
  ResponseList<Dim> responses_;     ///< terms, which are the model's, constraints, functionals
  std::vector<std::string> types_;  ///< of responses_
  std::vector<bool> has_check_;     ///< of constraints: ResponseTraits::exact_check
  AdaptiveLimits limits_;
  std::size_t configured_ = 0;  ///< terms and constraints
  std::vector<double> sizes_;   ///< of terms, what tells their values from rounding; 0: nothing does
  std::vector<Squares> squares_;
  std::optional<std::size_t> largest_;  ///< term that is the largest of several values: those of the response
                                        ///< after the configured ones, and there are no functionals
  std::vector<double> first_values_;
};

}  // namespace fabseq
