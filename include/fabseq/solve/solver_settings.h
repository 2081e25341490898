// SPDX-License-Identifier: MIT
/// \file
/// Which solver, and how closely it solves.
#pragma once

#include "fabseq/lanes/solver_cycle.h"

#include <algorithm>
#include <optional>

namespace fabseq {

template <class Settings>
class Section;

enum class SolverPath { lanes, reference };
enum class ReferenceMethod { automatic, gamg, multigrid, direct };

struct SolverSettings {
  /// What a tolerance that follows the design ends with, and what all else is solved to.
  static constexpr double finest_automatic = 1e-6;

  /// Preconditioned residual, docs/formulation.md 4.1; none: an optimization begins coarsely and follows its
  /// design (9).
  std::optional<double> tolerance = finest_automatic;
  SolverPath path = SolverPath::lanes;
  SolverCycle cycle = SolverCycle::k;
  int smoother_degree = 2;
  ReferenceMethod method = ReferenceMethod::automatic;
  std::optional<int> layer_groups;  ///< none: by ranks, layers and memory
  std::optional<int> lanes;         ///< none: by memory

  /// The tolerance of all solves but those on an optimization's way.
  double finest_tolerance() const { return tolerance.value_or(finest_automatic); }
};

/// How closely systems are solved in an iteration: those of the design's values, the adjoint ones of its
/// gradients, and those of values that only compare iterates.
struct Tolerances {
  double primal = SolverSettings::finest_automatic;
  double adjoint = SolverSettings::finest_automatic;
  double judged = SolverSettings::finest_automatic;

  static constexpr Tolerances all(double tolerance) { return {tolerance, tolerance, tolerance}; }
};

/// Conjugate gradients stop making progress below this.
constexpr double smallest_tolerance = 1e-13;

/// Elasticity is solved to `tolerance`, and so are all adjoints. Heat is solved a thousand times closer: its
/// error enters all others.
constexpr double elasticity_tolerance(double tolerance) { return std::max(tolerance, smallest_tolerance); }
constexpr double heat_tolerance(double tolerance) { return std::max(1e-3 * tolerance, smallest_tolerance); }

/// Section "solver".
Section<SolverSettings> solver_keys();

}  // namespace fabseq
