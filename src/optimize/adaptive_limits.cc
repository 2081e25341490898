// SPDX-License-Identifier: MIT
#include "fabseq/optimize/adaptive_limits.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr double stricter = 0.85, wider = 1.1;
/// How near to its limit a count is that says something about it, as a logarithm.
constexpr double near = 0.3;
/// The most that a limit changes altogether.
constexpr double most = 1e4;
constexpr const char* array = "problem/limit_factors";

}  // namespace

void AdaptiveLimits::adapt(std::size_t constraint, double violation, double share, bool may_widen) {
  double& factor = factors_[constraint];
  // What the optimizer has not reached yet tells nothing of a stricter limit, what it keeps by far nothing of
  // a wider one.
  if (share > 0.0 && violation < near) factor *= stricter;
  if (may_widen && share == 0.0 && violation > -near) factor *= wider;
  factor = std::clamp(factor, 1.0 / most, most);
}

void AdaptiveLimits::save(CheckpointState& state) const {
  if (!factors_.empty()) state.set_array(array, factors_);
}

void AdaptiveLimits::restore(const CheckpointState& state) {
  if (!factors_.empty()) factors_ = state.array(array);
}

}  // namespace fabseq
