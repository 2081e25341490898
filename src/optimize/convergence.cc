// SPDX-License-Identifier: MIT
#include "fabseq/optimize/convergence.h"

#include "fabseq/base/refusal.h"

#include <algorithm>

namespace fabseq {

namespace {

std::string in_the_window(const OptimizerSettings& optimizer) {
  const std::string iterations = optimizer.window == 1 ? " iteration" : " iterations";
  return " in the last " + std::to_string(optimizer.window) + iterations + " at the last sharpness";
}

}  // namespace

Convergence::Convergence(const OptimizerSettings& optimizer, double merit_unit)
    : optimizer_(optimizer), merit_unit_(merit_unit > 0.0 ? merit_unit : 1.0) {}

void Convergence::add(double beta, double change, double merit) {
  if (beta != beta_) {
    changes_.clear();
    merits_.clear();
  }
  beta_ = beta;
  if (window_is_full()) {
    changes_.erase(changes_.begin());
    merits_.erase(merits_.begin());
  }
  changes_.push_back(change);
  merits_.push_back(merit);
}

std::string Convergence::reason(bool feasible) const {
  if (!window_is_full()) return "";
  const double change = *std::max_element(changes_.begin(), changes_.end());
  if (change < optimizer_.change_tolerance)
    return "no variable moved by change_tolerance " + shown(optimizer_.change_tolerance) + " of its range" +
           in_the_window(optimizer_);
  const auto [least, most] = std::minmax_element(merits_.begin(), merits_.end());
  if (feasible && *most - *least < optimizer_.objective_tolerance * merit_unit_)
    return "the objective varied by less than objective_tolerance " + shown(optimizer_.objective_tolerance) +
           in_the_window(optimizer_);
  return "";
}

void Convergence::save(CheckpointState& state) const {
  state.set_scalar("convergence/beta", beta_);
  if (changes_.empty()) return;
  state.set_array("convergence/changes", changes_);
  state.set_array("convergence/merits", merits_);
}

/// A window that has become shorter keeps the latest.
void Convergence::restore(const CheckpointState& state) {
  changes_.clear();
  merits_.clear();
  beta_ = state.number("convergence/beta");
  if (!state.has_array("convergence/changes")) return;
  const std::vector<double>& changes = state.array("convergence/changes");
  const std::vector<double>& merits = state.array("convergence/merits");
  for (std::size_t i = 0; i < changes.size(); ++i) add(beta_, changes[i], merits[i]);
}

}  // namespace fabseq
