#include "fabseq/optimize/best_iterate.h"

namespace fabseq {

void BestIterate::offer(int iteration, double beta, const ProblemValues& values, const Design& design) {
  const bool now_feasible = values.worst_constraint <= 0.0;
  const bool descends = values.merit < merit_;
  const bool better = iteration_ == 0 || beta != beta_ || (now_feasible && (!feasible() || descends)) ||
                      (!now_feasible && !feasible() &&
                       (values.worst_constraint < worst_constraint_ ||
                        (values.worst_constraint == worst_constraint_ && descends)));
  if (!better) return;
  iteration_ = iteration;
  beta_ = beta;
  worst_constraint_ = values.worst_constraint;
  merit_ = values.merit;
  design_ = design;
}

void BestIterate::save(CheckpointState& state) const {
  state.set_scalar("best/iteration", iteration_);
  if (iteration_ == 0) return;
  state.set_scalar("best/beta", beta_);
  state.set_scalar("best/worst_constraint", worst_constraint_);
  state.set_scalar("best/merit", merit_);
  state.set_field("best/design", design_.field);
  if (!design_.layer_variables.empty()) state.set_array("best/" + layer_variables_, design_.layer_variables);
}

void BestIterate::restore(const CheckpointState& state) {
  iteration_ = state.integer("best/iteration");
  if (iteration_ == 0) return;
  beta_ = state.number("best/beta");
  worst_constraint_ = state.number("best/worst_constraint");
  merit_ = state.number("best/merit");
  design_.field = state.field("best/design");
  if (state.has_array("best/" + layer_variables_))
    design_.layer_variables = state.array("best/" + layer_variables_);
}

}  // namespace fabseq
