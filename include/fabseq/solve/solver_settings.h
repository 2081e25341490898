// SPDX-License-Identifier: MIT
/// \file
/// Which solver, and how closely it solves.
#pragma once

#include "fabseq/multigrid/lane_cycle.h"
#include "fabseq/solve/solve_tolerance.h"

#include <optional>

namespace fabseq {

template <class Settings>
class Section;

enum class SolverPath { lanes, reference };
/// What the systems of a block of layers consist of (docs/formulation.md 4.8): all elements, or those that
/// are built by then; automatic: Model::solver has one of the two, and solvers take it as whole.
enum class SolverRegion { automatic, whole, built };
enum class ReferenceMethod { automatic, gamg, multigrid, direct };

struct SolverSettings {
  /// What a tolerance that follows the design ends with, and what all else is solved to.
  static constexpr double finest_automatic = SolveTolerance{}.value;

  /// Preconditioned residual, docs/formulation.md 4.1; none: an optimization begins coarsely and follows its
  /// design (9).
  std::optional<double> tolerance = finest_automatic;
  SolverPath path = SolverPath::lanes;
  SolverCycle cycle = SolverCycle::k;
  int smoother_degree = 2;
  ReferenceMethod method = ReferenceMethod::automatic;
  SolverRegion region = SolverRegion::automatic;
  std::optional<int> layer_groups;  ///< none: by ranks, layers and memory
  std::optional<int> lanes;         ///< none: by memory

  /// Elements of single evaluations, which are all unless asked otherwise.
  SolverRegion region_of_evaluations() const {
    return region == SolverRegion::built ? SolverRegion::built : SolverRegion::whole;
  }
  /// The tolerance of all solves but those on an optimization's way.
  double finest_tolerance() const { return tolerance.value_or(finest_automatic); }
  /// The same of what an optimization reports, where displacements of plastic flow may change by 1e-5 yet.
  SolveTolerance tolerance_of_reports() const {
    return {finest_tolerance(), 1.0, std::max(1e-5, SolveTolerance{finest_tolerance()}.flow_change())};
  }
};

/// How closely systems are solved in an iteration: those of the design's values, the adjoint ones of its
/// gradients, and those of values that only compare iterates.
struct Tolerances {
  SolveTolerance primal, adjoint, judged;

  static constexpr Tolerances all(const SolveTolerance& tolerance) {
    return {tolerance, tolerance, tolerance};
  }
};

/// Section "solver".
Section<SolverSettings> solver_keys();

}  // namespace fabseq
