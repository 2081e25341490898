/// \file
/// What an iteration finds out about its design.
#pragma once

#include "fabseq/optimize/problem.h"

#include <algorithm>
#include <optional>

namespace fabseq {

/// The same on all ranks.
struct Iterate {
  int iteration = 0;
  double beta = 0.0;                    ///< sharpness of the layers of `values`
  ProblemValues values;                 ///< what the optimizer goes by
  std::optional<ProblemValues> binary;  ///< of binary layers, where the iterate is judged by these

  /// By which iterates are compared (BestIterate).
  double merit() const { return binary ? binary->merit : values.merit; }
  /// Whatever is judged by, the optimizer's own constraints hold as well.
  double worst_constraint() const {
    return binary ? std::max(values.worst_constraint, binary->worst_constraint) : values.worst_constraint;
  }
};

}  // namespace fabseq
