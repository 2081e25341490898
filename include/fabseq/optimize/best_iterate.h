// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/design.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/optimize/problem.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// How an iterate's constraints stand, best first. Volumes of binary layers come in whole elements, so what
/// smooth layers satisfy may be out of their reach: `within_elements` says that the optimizer's own
/// constraints hold and theirs are missed by little. `left_to_checks` says so of the constraints without an
/// exact check: smooth counts of the machine's limits are stricter than the checks, which judge these.
enum class Standing { satisfied, within_elements, left_to_checks, violated };

/// What binary layers may miss constraints by, in the unit of `worst_constraint`.
inline constexpr double binary_allowance = 0.01;

/// How far binary layers are beyond the limits of the machine, by the exact checks.
struct BeyondLimits {
  double share = 0.0;          ///< of the part, beyond those limits that constraints of the config count
  std::vector<double> shares;  ///< beyond the limit of each constraint; 0 of those without an exact check
  std::int64_t places = 0;     ///< at which any check fails
};

/// Values of binary layers.
struct JudgedValues : ProblemValues {
  std::optional<BeyondLimits> beyond_limits;  ///< none without constraints that have an exact check
};

/// What an iteration finds out about its design; the same on all ranks.
struct Iterate {
  int iteration = 0;
  double beta = 0.0;                   ///< sharpness of the layers of `values`
  ProblemValues values;                ///< what the optimizer goes by
  std::optional<JudgedValues> binary;  ///< of binary layers, where the iterate is judged by these

  /// Returns what iterates are compared by (BestIterate): the worse of both, as an iterate that is good in
  /// one kind of layers alone owes that to the soft bounds of these, or to where elements happen to lie.
  double merit() const { return binary ? std::max(values.merit, binary->merit) : values.merit; }
  double worst_constraint() const {
    return binary ? std::max(values.worst_constraint, binary->worst_constraint) : values.worst_constraint;
  }
  Standing standing() const {
    const bool keeps_limits = !binary || !binary->beyond_limits || binary->beyond_limits->share == 0.0;
    if (worst_constraint() <= 0.0 && keeps_limits) return Standing::satisfied;
    if (!binary) return Standing::violated;
    if (values.worst_constraint <= 0.0 && binary->worst_constraint <= binary_allowance && keeps_limits)
      return Standing::within_elements;
    const bool others_hold = values.worst_unchecked <= 0.0 && binary->worst_unchecked <= binary_allowance;
    return binary->beyond_limits && others_hold ? Standing::left_to_checks : Standing::violated;
  }
  /// What counts before the merit.
  double shortfall() const {
    switch (standing()) {
      case Standing::left_to_checks:
        return binary->beyond_limits->share;
      case Standing::violated:
        return worst_constraint();
      default:
        return 0.0;
    }
  }
};

/// Keeps the best of the designs offered so far, with which a run ends (docs/formulation.md 9): the one whose
/// constraints stand best, then the one of smaller merit; where constraints are violated, the smaller
/// shortfall counts first, and where it is the same (all that it depends on may be fixed) the merit. Local to
/// the rank; ranks agree because values do.
class BestIterate {
 public:
  /// `layer_variables`: their name, for checkpoints.
  explicit BestIterate(std::string layer_variables) : layer_variables_(std::move(layer_variables)) {}

  /// Designs at another sharpness cannot be compared, nor those judged by other layers: a new `beta`, or the
  /// first that is judged by binary layers, starts over.
  void offer(const Iterate& iterate, const Design& design);

  int iteration() const { return iteration_; }
  double beta() const { return beta_; }
  double worst_constraint() const { return worst_constraint_; }
  bool by_binary() const { return by_binary_; }
  double merit() const { return merit_; }
  bool feasible() const { return standing_ == Standing::satisfied; }
  /// Whether exact checks are all that it fails: more iterations may mend it.
  bool fails_checks() const { return standing_ == Standing::left_to_checks && shortfall_ > 0.0; }
  const Design& design() const { return design_; }

  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  std::string layer_variables_;
  int iteration_ = 0;
  bool by_binary_ = false;  ///< judged by binary layers
  Standing standing_ = Standing::violated;
  double beta_ = 0.0, worst_constraint_ = 0.0, shortfall_ = 0.0, merit_ = 0.0;
  Design design_;
};

}  // namespace fabseq
