// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/layers/layer_model.h"
#include "fabseq/mma/mma.h"
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

/// Moves a design by the method of moving asymptotes: its field in the unit variable of a DesignSpace, and
/// the layers' variables, which the first rank has, within their bounds and their reach. What is fixed stays
/// where it is. Collective.
class DesignUpdate {
 public:
  /// `space`: of this rank's part of the field; `field_is_fixed`: it is kept from the optimizer; `design`:
  /// one of the same sizes.
  DesignUpdate(MPI_Comm comm, const DesignSpace& space, bool field_is_fixed, LayerVariables layer_variables,
               const Design& design, const MmaSettings& settings);

  /// `design` in and out; gradients with respect to the design.
  StepReport update(Design& design, ProblemGradients gradients, double move_limit);

  /// The optimizer's memory: asymptotes and the last two designs. Saving is collective.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  /// Whether this rank has the layers' variables among its own.
  bool has_layer_variables() const { return layer_variable_count() > 0 && rank_of(comm_) == 0; }
  std::size_t layer_variable_count() const { return layer_variables_.fixed ? 0 : layer_variables_.count(); }
  /// This rank's variables for MMA.
  std::vector<double> to_variables(const Design& design) const;
  std::vector<double> gradient_of_variables(Design gradient, const Design& design) const;
  void save_vector(CheckpointState& state, const std::string& name, const std::vector<double>& values) const;
  std::vector<double> restored_vector(const CheckpointState& state, const std::string& name) const;

  MPI_Comm comm_;
  DesignSpace space_;
  bool field_is_fixed_;
  LayerVariables layer_variables_;
  std::size_t field_size_;  ///< 0 if the field is fixed
  Mma mma_;
};

}  // namespace fabseq
