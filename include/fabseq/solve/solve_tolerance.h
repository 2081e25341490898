// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

namespace fabseq {

/// How closely a system is solved.
struct SolveTolerance {
  double value = 1e-6;  ///< preconditioned residual, docs/formulation.md 4.1
  /// LaneStop::reach. The reference path stops at the value.
  double reach = 1.0;
  /// Change of the displacements, relative to them, with which the sweeps of plastic flow end; 0: a tenth of
  /// the value.
  double flow = 0.0;
  /// Whether elastic solves and the sequence's own equation begin with the last solutions of their kind, and
  /// leave theirs for the next.
  bool warm = false;
  /// The value where stiff pieces hang in soft surroundings (LaneStop::of_islands); 0: the same. The
  /// reference path, which looks for none, takes the smaller of both.
  double of_islands = 0.0;
  /// Whether solves are corrections of an outer iteration, which goes on with what they leave: at most
  /// `correction_steps`; with a reach above 1, and where no piece hangs, one cycle (LaneStop::one_cycle). The
  /// reference path stops at the value.
  bool correction = false;
  /// The value for the sequence's own equation, which begins with its last solution then; 0: a thousandth of
  /// the value.
  double of_sequence = 0.0;

  double smallest() const { return of_islands > 0.0 ? std::min(value, of_islands) : value; }
  /// Not below what rounding leaves.
  double flow_change() const { return flow > 0.0 ? flow : std::max(0.1 * value, 1e-11); }
};

/// Steps of a correction at most.
constexpr int correction_steps = 40;

/// Conjugate gradients stop making progress below this.
constexpr double smallest_tolerance = 1e-13;

/// Elasticity is solved to a run's tolerance, and so are the adjoints of sequences. The sequence's heat
/// equation itself is solved a thousand times closer: its error enters all others. The steps of the part's
/// temperature and their adjoints are solved ten times closer, at least to 1e-4: many follow each other.
constexpr SolveTolerance elasticity_tolerance(const SolveTolerance& of_run) {
  return {std::max(of_run.value, smallest_tolerance), of_run.reach, of_run.flow, of_run.warm};
}
constexpr SolveTolerance sequence_tolerance(const SolveTolerance& of_run) {
  if (of_run.of_sequence > 0.0) return {.value = of_run.of_sequence, .warm = true};
  return {
      .value = std::max(1e-3 * of_run.value, smallest_tolerance), .reach = of_run.reach, .warm = of_run.warm};
}
constexpr SolveTolerance step_tolerance(const SolveTolerance& of_run) {
  // Closer than that, steps on a region of two ranks were seen to end in no progress.
  return {std::clamp(0.1 * of_run.value, 3.0 * smallest_tolerance, 1e-4), of_run.reach};
}

}  // namespace fabseq
