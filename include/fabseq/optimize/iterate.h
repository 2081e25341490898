// SPDX-License-Identifier: MIT
/// \file
/// What an iteration finds out about its design.
#pragma once

#include "fabseq/optimize/problem.h"

#include <algorithm>
#include <optional>

namespace fabseq {

/// How an iterate's constraints stand, best first. Volumes of binary layers come in whole elements, so what
/// smooth layers satisfy may be out of their reach: `within_elements` says that the optimizer's own
/// constraints hold and theirs are missed by little.
enum class Standing { satisfied, within_elements, violated };

/// They may be missed by this much, in the unit of `worst_constraint`.
inline constexpr double binary_allowance = 0.01;

/// The same on all ranks.
struct Iterate {
  int iteration = 0;
  double beta = 0.0;                    ///< sharpness of the layers of `values`
  ProblemValues values;                 ///< what the optimizer goes by
  std::optional<ProblemValues> binary;  ///< of binary layers, where the iterate is judged by these

  /// By which iterates are compared (BestIterate): the worse of both, as an iterate that is good in one kind
  /// of layers alone owes that to the soft bounds of these, or to where elements happen to lie.
  double merit() const { return binary ? std::max(values.merit, binary->merit) : values.merit; }
  double worst_constraint() const {
    return binary ? std::max(values.worst_constraint, binary->worst_constraint) : values.worst_constraint;
  }
  Standing standing() const {
    if (worst_constraint() <= 0.0) return Standing::satisfied;
    const bool within =
        binary && values.worst_constraint <= 0.0 && binary->worst_constraint <= binary_allowance;
    return within ? Standing::within_elements : Standing::violated;
  }
};

}  // namespace fabseq
