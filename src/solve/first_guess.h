// SPDX-License-Identifier: MIT
#pragma once

namespace fabseq {

/// What a solver's iteration begins with: zero, or what the vector of the solution holds.
enum class FirstGuess { zero, given };

}  // namespace fabseq
