// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <vector>

namespace fabseq {

enum class SolverCycle { k, w, v };

/// What the multigrid does in a cycle. Levels below the finest are visited once (V), several times as a fixed
/// iteration (W: fewer reductions, for many ranks), or in several steps of conjugate gradients (K: strongest;
/// needs a flexible method outside).
struct LaneCycle {
  SolverCycle kind = SolverCycle::k;
  int degree = 2;       ///< of the Chebyshev smoother, before and after
  bool islands = true;  ///< LaneCg: rigid motions of stiff islands, where lanes have operators of their own
  std::vector<int> steps{2, 4, 2};  ///< steps on levels 1, 2, ... (K) or visits (W); the last entry goes on
  std::vector<int> patient_steps{6, 4, 2};  ///< the same for lanes that take long (K only)
  int patient_end = 8;                      ///< theirs on the level before the last, from the third on
  int patience = 10;                        ///< iterations before a lane counts as one that takes long
  bool narrows = true;  ///< LaneCg: lanes that are left over go on in a narrower solver, which takes memory
  double shift = 0.0;   ///< added to the last level's diagonal, relative to it: for bodies that nothing holds

  /// Steps on a level of `levels`, the finest being 0.
  int steps_on(int level, int levels, bool patient) const {
    if (kind == SolverCycle::v) return 1;
    const bool waits = patient && kind == SolverCycle::k;
    if (waits && level >= 3 && level + 2 == levels) return patient_end;
    const std::vector<int>& list = waits ? patient_steps : steps;
    return list[std::min<std::size_t>(level - 1, list.size() - 1)];
  }
  LaneCycle narrowing(bool wanted) const {
    LaneCycle result = *this;
    result.narrows = wanted;
    return result;
  }
};

}  // namespace fabseq
