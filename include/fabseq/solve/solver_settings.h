// SPDX-License-Identifier: MIT
/// \file
/// Which solver, and how closely it solves.
#pragma once

#include "fabseq/lanes/solver_cycle.h"

#include <optional>

namespace fabseq {

template <class Settings>
class Section;

enum class SolverPath { lanes, reference };
enum class ReferenceMethod { automatic, gamg, multigrid, direct };

struct SolverSettings {
  double tolerance = 1e-6;  ///< preconditioned residual, docs/formulation.md 4.1
  SolverPath path = SolverPath::lanes;
  SolverCycle cycle = SolverCycle::k;
  int smoother_degree = 2;
  ReferenceMethod method = ReferenceMethod::automatic;
  std::optional<int> layer_groups;  ///< none: by ranks, layers and memory
  std::optional<int> lanes;         ///< none: by memory
};

/// Section "solver".
Section<SolverSettings> solver_keys();

}  // namespace fabseq
