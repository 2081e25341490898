// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/checkpoint_state.h"

#include <cstddef>
#include <vector>

namespace fabseq {

/// Limits of smooth counts that follow the exact checks (docs/developer/repair.md 13.2): what each
/// constraint's first limit is multiplied by. Local; ranks agree because what they are told does.
class AdaptiveLimits {
 public:
  /// All factors are 1.
  explicit AdaptiveLimits(std::size_t constraints) : factors_(constraints, 1.0) {}

  double factor(std::size_t constraint) const { return factors_[constraint]; }
  const std::vector<double>& factors() const { return factors_; }
  /// Moves a limit after an iterate.
  /// \param violation  largest ln(count / limit) of the constraint's components
  /// \param share      of the part that the exact check finds beyond
  /// \param may_widen  whether a limit may also become wider
  void adapt(std::size_t constraint, double violation, double share, bool may_widen);

  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  std::vector<double> factors_;
};

}  // namespace fabseq
