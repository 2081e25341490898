#include "fabseq/optimize/best_iterate.h"

namespace fabseq {

void BestIterate::offer(int iteration, double beta, const ProblemValues& values,
                        const std::vector<double>& design) {
  const bool now_feasible = values.worst_constraint <= 0.0;
  const bool better = iteration_ == 0 || beta != beta_ ||
                      (now_feasible && (!feasible() || values.merit < merit_)) ||
                      (!now_feasible && !feasible() && values.worst_constraint < worst_constraint_);
  if (!better) return;
  iteration_ = iteration;
  beta_ = beta;
  worst_constraint_ = values.worst_constraint;
  merit_ = values.merit;
  design_ = design;
}

}  // namespace fabseq
