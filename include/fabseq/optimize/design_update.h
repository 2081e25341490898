/// \file
/// One step of the optimizer on the scale the design moves on.
#pragma once

#include "fabseq/io/checkpoint_state.h"
#include "fabseq/optimize/mma.h"
#include "fabseq/optimize/problem.h"
#include "fabseq/sequence/sequence.h"

#include <string>
#include <vector>

namespace fabseq {

/// What a step did.
struct StepReport {
  double change = 0.0;  ///< largest change of a variable, fraction of its range, all ranks
  MmaReport mma;
};

/// Moves a design by the method of moving asymptotes: its field in the unit variable of a DesignSpace, and time points,
/// which the first rank has as variables, over a range of a layer to either side. Collective.
class DesignUpdate {
 public:
  /// `space`: of the field; `design`: one of the same sizes.
  DesignUpdate(MPI_Comm comm, const DesignSpace& space, const Design& design,
               const OptimizerSettings& settings);

  /// `design` in and out; gradients with respect to the design.
  StepReport update(Design& design, const ProblemGradients& gradients, double move_limit);

  /// The optimizer's memory: asymptotes and the last two designs. Saving is collective.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  /// Whether this rank has the time points as variables.
  bool has_time_points() const;
  /// This rank's variables for MMA.
  std::vector<double> to_variables(const Design& design) const;
  std::vector<double> gradient_of_variables(const Design& gradient, const Design& design) const;
  void add_residuals(const ProblemGradients& gradients, const Design& design, MmaRows& kinds,
                     std::vector<double>& values, std::vector<std::vector<double>>& rows) const;
  void save_vector(CheckpointState& state, const std::string& name, const std::vector<double>& values) const;
  std::vector<double> restored_vector(const CheckpointState& state, const std::string& name) const;

  MPI_Comm comm_;
  DesignSpace space_;
  std::size_t field_size_, time_point_count_;
  Mma mma_;
};

}  // namespace fabseq
