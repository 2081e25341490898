// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/solve/solver_settings.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

/// The tolerance of an iteration's elastic solves that its step allows (docs/formulation.md 9): the errors of
/// the objective shall be a small share of what the step changes, from 1e-3 to the finest.
///
/// \param move_limit largest step of a variable, as a share of its range
/// \param share_left of the first distortion, a sum of squares, from 0 to 1. What is left by cancellation has
/// the errors of what was there before.
inline double following_tolerance(double move_limit, double share_left) {
  constexpr double coarsest = 1e-3, per_step = 0.02;
  return std::clamp(per_step * move_limit * std::sqrt(share_left), SolverSettings::finest_automatic,
                    coarsest);
}

}  // namespace fabseq
