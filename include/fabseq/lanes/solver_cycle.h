// SPDX-License-Identifier: MIT
/// \file
/// The cycle of the lane multigrid.
#pragma once

namespace fabseq {

enum class SolverCycle { k, w, v };

}  // namespace fabseq
