// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/chain/design.h"
#include "fabseq/report/constraint_miss.h"

#include <optional>
#include <vector>

namespace fabseq {

/// What an optimization comes to, for a run that begins with it. The same on all ranks but for the design.
struct RunOutcome {
  Design design;                  ///< the best, as its own setup shares it out
  std::vector<double> objective;  ///< its terms, [component]
  bool feasible = false;
  double worst_constraint = 0.0, merit = 0.0;
  std::optional<ConstraintMiss> miss;  ///< none if all constraints hold
  Json starts;                         ///< of summary.json; null: it began with a single design
};

}  // namespace fabseq
