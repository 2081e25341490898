// SPDX-License-Identifier: MIT
#include "fabseq/optimize/run_state.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace fabseq {

namespace {

std::string in_the_window(const OptimizerSettings& optimizer) {
  const std::string iterations = optimizer.window == 1 ? " iteration" : " iterations";
  return " in the last " + std::to_string(optimizer.window) + iterations + " at the last sharpness";
}

std::string text(double number) {
  std::ostringstream stream;
  stream << number;
  return stream.str();
}

}  // namespace

/// Share of the run with the full move limit.
constexpr double free_share = 0.4;

Continuation::Continuation(const ProjectionSettings& projection, double first_beta, double last_beta,
                           const OptimizerSettings& optimizer)
    : projection_(projection),
      first_beta_(first_beta),
      last_beta_(std::max(first_beta, last_beta)),
      optimizer_(optimizer),
      earlier_iterations_(optimizer.earlier_iterations + optimizer.coarse_iterations),
      planned_iterations_(earlier_iterations_ + optimizer.max_iterations + optimizer.later_iterations) {}

double Continuation::beta(int iteration) const {
  double beta = first_beta_;
  for (int step = projection_.interval; step < earlier_iterations_ + iteration; step += projection_.interval)
    beta = std::min(last_beta_, beta * projection_.factor + projection_.increment);
  return beta;
}

bool Continuation::at_last_beta(int iteration) const {
  return beta(iteration) == beta(optimizer_.max_iterations);
}

double Continuation::move_limit(int iteration) const {
  const double progress = static_cast<double>(earlier_iterations_ + iteration) / planned_iterations_;
  if (progress <= free_share) return optimizer_.move_limit;
  const double share = std::min(1.0, (progress - free_share) / (1.0 - free_share));
  return optimizer_.move_limit * std::pow(optimizer_.final_move_limit / optimizer_.move_limit, share);
}

void Continuation::save(CheckpointState& state) const {
  state.set_scalar("continuation/planned_iterations", planned_iterations_);
}

void Continuation::restore(const CheckpointState& state) {
  planned_iterations_ = state.integer("continuation/planned_iterations");
}

Convergence::Convergence(const OptimizerSettings& optimizer, double merit_unit)
    : optimizer_(optimizer), merit_unit_(merit_unit > 0.0 ? merit_unit : 1.0) {}

void Convergence::add(double beta, double change, double merit) {
  if (beta != beta_) {
    changes_.clear();
    merits_.clear();
  }
  beta_ = beta;
  if (window_is_full()) {
    changes_.erase(changes_.begin());
    merits_.erase(merits_.begin());
  }
  changes_.push_back(change);
  merits_.push_back(merit);
}

std::string Convergence::reason(bool feasible) const {
  if (!window_is_full()) return "";
  const double change = *std::max_element(changes_.begin(), changes_.end());
  if (change < optimizer_.change_tolerance)
    return "no variable moved by change_tolerance " + text(optimizer_.change_tolerance) + " of its range" +
           in_the_window(optimizer_);
  const auto [least, most] = std::minmax_element(merits_.begin(), merits_.end());
  if (feasible && *most - *least < optimizer_.objective_tolerance * merit_unit_)
    return "the objective varied by less than objective_tolerance " + text(optimizer_.objective_tolerance) +
           in_the_window(optimizer_);
  return "";
}

void Convergence::save(CheckpointState& state) const {
  state.set_scalar("convergence/beta", beta_);
  if (changes_.empty()) return;
  state.set_array("convergence/changes", changes_);
  state.set_array("convergence/merits", merits_);
}

/// A window that has become shorter keeps the latest.
void Convergence::restore(const CheckpointState& state) {
  changes_.clear();
  merits_.clear();
  beta_ = state.number("convergence/beta");
  if (!state.has_array("convergence/changes")) return;
  const std::vector<double>& changes = state.array("convergence/changes");
  const std::vector<double>& merits = state.array("convergence/merits");
  for (std::size_t i = 0; i < changes.size(); ++i) add(beta_, changes[i], merits[i]);
}

template <int Dim>
RunState<Dim>::RunState(const Model<Dim>& model, const OptimizerSettings& settings,
                        const Sequence<Dim>& sequence, Design design)
    : problem(model, settings.constraint_margin),
      continuation(model.settings.projection, model.layers->traits().first_beta,
                   model.layers->traits().last_beta, settings),
      optimizer(model.world(), sequence.space(), model.layers->traits().time_is_fixed,
                model.layers->variables(), design, settings.mma),
      best(model.layers->variables().name),
      settings_(settings),
      layer_variables_(model.layers->variables()),
      design_(std::move(design)),
      convergence_(settings, problem.merit_unit()) {}

template <int Dim>
void RunState<Dim>::complete(Design next, double change, const ProblemValues& values) {
  design_ = std::move(next);
  ++completed_;
  convergence_.add(continuation.beta(completed_), change, values.merit);
}

template <int Dim>
std::string RunState<Dim>::convergence() const {
  if (completed_ == 0 || !continuation.at_last_beta(completed_)) return "";
  return convergence_.reason(best.feasible());
}

template <int Dim>
RunEnd RunState<Dim>::end() const {
  const std::string reason = convergence();
  if (!reason.empty()) return {"converged", reason, completed_};
  const char* too_short = continuation.reaches_the_end() ? "" : " before the sharpness reached its maximum";
  return {"iteration_limit", std::string("max_iterations reached") + too_short, completed_};
}

template <int Dim>
CheckpointState RunState<Dim>::save() const {
  CheckpointState state;
  state.set_scalar("iteration", completed_);
  state.set_scalar("beta", continuation.beta(completed_ + 1));
  state.set_field("design", design_.field);
  if (!design_.layer_variables.empty()) state.set_array(layer_variables_.name, design_.layer_variables);
  problem.save(state);
  continuation.save(state);
  optimizer.save(state);
  best.save(state);
  convergence_.save(state);
  return state;
}

template <int Dim>
void RunState<Dim>::restore(const CheckpointState& state) {
  completed_ = state.integer("iteration");
  design_.field = state.field("design");
  if (!design_.layer_variables.empty()) design_.layer_variables = state.array(layer_variables_.name);
  problem.restore(state);
  continuation.restore(state);
  optimizer.restore(state);
  best.restore(state);
  convergence_.restore(state);
}

FABSEQ_INSTANTIATE_CLASS(RunState);

}  // namespace fabseq
