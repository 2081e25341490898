// SPDX-License-Identifier: MIT
#include "fabseq/optimize/continuation.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Share of the run with the full move limit.
constexpr double free_share = 0.4;
/// Share of the run after which it nears its end.
constexpr double end_share = 0.9;

}  // namespace

Continuation::Continuation(const ProjectionSettings& projection, double first_beta, double last_beta,
                           const OptimizerSettings& optimizer)
    : projection_(projection),
      first_beta_(first_beta),
      last_beta_(std::max(first_beta, last_beta)),
      optimizer_(optimizer),
      earlier_iterations_(optimizer.earlier_iterations + optimizer.coarse_iterations +
                          (optimizer.starts.empty() ? 0 : optimizer.start_iterations)),
      planned_iterations_(earlier_iterations_ + optimizer.max_iterations + optimizer.later_iterations) {}

double Continuation::scheduled_beta(int iteration) const {
  double beta = first_beta_;
  for (int step = projection_.interval; step < earlier_iterations_ + iteration; step += projection_.interval)
    beta = std::min(last_beta_, beta * projection_.factor + projection_.increment);
  return beta;
}

bool Continuation::at_last_beta(int iteration) const {
  return beta(iteration) == beta(optimizer_.max_iterations);
}

double Continuation::move_limit(int iteration) const {
  const double done = progress(iteration);
  if (done <= free_share) return optimizer_.move_limit;
  const double share = std::min(1.0, (done - free_share) / (1.0 - free_share));
  return optimizer_.move_limit * std::pow(optimizer_.final_move_limit / optimizer_.move_limit, share);
}

bool Continuation::near_the_end(int iteration) const { return progress(iteration) > end_share; }

void Continuation::save(CheckpointState& state) const {
  state.set_scalar("continuation/planned_iterations", planned_iterations_);
}

void Continuation::restore(const CheckpointState& state) {
  planned_iterations_ = state.integer("continuation/planned_iterations");
}

}  // namespace fabseq
