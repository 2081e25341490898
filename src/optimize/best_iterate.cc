// SPDX-License-Identifier: MIT
#include "fabseq/optimize/best_iterate.h"

#include <tuple>

namespace fabseq {

void BestIterate::offer(const Iterate& iterate, const Design& design) {
  const std::tuple key(iterate.standing(), iterate.shortfall(), iterate.merit());
  const bool starts_over =
      iteration_ == 0 || iterate.beta != beta_ || iterate.binary.has_value() != by_binary_;
  if (!starts_over && !(key < std::tuple(standing_, shortfall_, merit_))) return;
  iteration_ = iterate.iteration;
  by_binary_ = iterate.binary.has_value();
  std::tie(standing_, shortfall_, merit_) = key;
  beta_ = iterate.beta;
  worst_constraint_ = iterate.worst_constraint();
  design_ = design;
}

void BestIterate::save(CheckpointState& state) const {
  state.set_scalar("best/iteration", iteration_);
  if (iteration_ == 0) return;
  state.set_scalar("best/by_binary", by_binary_ ? 1 : 0);
  state.set_scalar("best/standing", static_cast<int>(standing_));
  state.set_scalar("best/beta", beta_);
  state.set_scalar("best/worst_constraint", worst_constraint_);
  state.set_scalar("best/shortfall", shortfall_);
  state.set_scalar("best/merit", merit_);
  state.set_field("best/design", design_.field);
  if (!design_.layer_variables.empty()) state.set_array("best/" + layer_variables_, design_.layer_variables);
}

void BestIterate::restore(const CheckpointState& state) {
  iteration_ = state.integer("best/iteration");
  if (iteration_ == 0) return;
  by_binary_ = state.integer("best/by_binary") != 0;
  standing_ = static_cast<Standing>(state.integer("best/standing"));
  beta_ = state.number("best/beta");
  worst_constraint_ = state.number("best/worst_constraint");
  shortfall_ = state.number("best/shortfall");
  merit_ = state.number("best/merit");
  design_.field = state.field("best/design");
  if (state.has_array("best/" + layer_variables_))
    design_.layer_variables = state.array("best/" + layer_variables_);
}

}  // namespace fabseq
