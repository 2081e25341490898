// SPDX-License-Identifier: MIT
/// \file
/// Cycle of the lane multigrid.
#pragma once

namespace fabseq {

enum class SolverCycle { v, w, k };

}  // namespace fabseq
