// SPDX-License-Identifier: MIT
#include "fabseq/optimize/run_state.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

Tolerances following_tolerances(double move_limit, double share_left) {
  constexpr double coarsest = 1e-2, per_step = 0.3, of_gradients = 3e-3, for_comparison = 0.001;
  // What a step of the solver divides the residual by.
  constexpr double usual_gain = 3.0;
  const double size_left = std::sqrt(share_left);
  const auto within = [&](double tolerance) {
    return SolveTolerance{std::clamp(tolerance, SolverSettings::finest_automatic, coarsest), usual_gain};
  };
  return {within(per_step * move_limit * size_left), within(of_gradients),
          within(for_comparison * size_left)};
}

template <int Dim>
RunState<Dim>::RunState(const Model<Dim>& model, const OptimizerSettings& settings,
                        const Sequence<Dim>& sequence, Design design)
    : problem(model, settings.constraint_margin),
      continuation(model.settings.projection, model.layers->traits().first_beta,
                   model.layers->traits().last_beta, settings),
      optimizer(model.world(), model.space_of_share(sequence), model.layers->traits().time_is_fixed,
                model.layers->variables(), design, settings.mma),
      best(model.layers->variables().name),
      model_(model),
      settings_(settings),
      design_(std::move(design)),
      convergence_(settings, problem.merit_unit()) {}

template <int Dim>
Tolerances RunState<Dim>::tolerances() const {
  const SolverSettings& solver = model_.settings.solver;
  const int iteration = completed_ + 1;
  Tolerances result = Tolerances::all({solver.finest_tolerance()});
  if (!solver.tolerance) {
    result = following_tolerances(continuation.move_limit(iteration), share_left_);
    if (continuation.near_the_end(iteration)) result.primal = result.judged;
    result.primal.warm = result.adjoint.warm = true;
    // Smooth layers then take the pseudo-time of the binary ones, which come first.
    result.judged.of_sequence =
        sequence_tolerance({std::min(result.primal.value, result.judged.value)}).value;
  }
  constexpr double of_sweeps = 0.01, for_comparison = 0.001;
  result.primal.flow = result.adjoint.flow = of_sweeps;
  result.judged.flow = for_comparison;
  return result;
}

template <int Dim>
void RunState<Dim>::complete(Design next, double change, const ProblemValues& values) {
  design_ = std::move(next);
  share_left_ = problem.share_left(values);
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
  if (completed_ > settings_.max_iterations)
    return {"iteration_limit", "max_iterations and what repairs reached", completed_};
  const char* too_short = continuation.reaches_the_end() ? "" : " before the sharpness reached its maximum";
  return {"iteration_limit", std::string("max_iterations reached") + too_short, completed_};
}

template <int Dim>
CheckpointState RunState<Dim>::save() const {
  CheckpointState state;
  state.set_scalar("iteration", completed_);
  state.set_scalar("beta", continuation.beta(completed_ + 1));
  state.set_scalar("share_left", share_left_);
  state.set_field("design", design_.field);
  if (!design_.layer_variables.empty())
    state.set_array(model_.layers->variables().name, design_.layer_variables);
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
  share_left_ = state.number("share_left");
  design_.field = state.field("design");
  if (!design_.layer_variables.empty())
    design_.layer_variables = state.array(model_.layers->variables().name);
  problem.restore(state);
  continuation.restore(state);
  optimizer.restore(state);
  best.restore(state);
  convergence_.restore(state);
}

FABSEQ_INSTANTIATE_CLASS(RunState);

}  // namespace fabseq
