/// \file
/// One step of the optimizer on the scale the design moves on.
#pragma once

#include "fabseq/io/checkpoint_state.h"
#include "fabseq/optimize/mma.h"
#include "fabseq/optimize/problem.h"
#include "fabseq/sequence/sequence.h"

#include <vector>

namespace fabseq {

/// What a step did.
struct StepReport {
  double change = 0.0;  ///< largest change of a variable, fraction of its range, all ranks
  MmaReport mma;
};

/// Moves a design by the method of moving asymptotes in the unit variable of its DesignSpace. Collective.
class DesignUpdate {
 public:
  DesignUpdate(MPI_Comm comm, const DesignSpace& space, std::size_t variables,
               const OptimizerSettings& settings);

  /// `design` in and out; gradients with respect to the design.
  StepReport update(std::vector<double>& design, const ProblemGradients& gradients, double move_limit);

  /// The optimizer's memory: asymptotes and the last two designs.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  MPI_Comm comm_;
  DesignSpace space_;
  Mma mma_;
};

}  // namespace fabseq
