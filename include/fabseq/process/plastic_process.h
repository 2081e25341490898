// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

class PlasticSweeps;

/// The layer-by-layer simulation of a material that flows, and whose modulus, yield stress and length follow
/// the temperature (docs/formulation.md 16). Many steps are solved at once: each sweep finds the history of
/// every element, and corrects the displacements of eight steps of each group by elastic solves, which
/// Anderson's method accelerates (PlasticSweeps). The release, which ends every simulation that has one, may
/// flow as well.
///
/// Layer groups share the steps when they solve, and the elements when they find histories (PlasticExchange).
/// A simulation begins from the displacements of the last one.
class PlasticProcess : public Process<3> {
 public:
  /// The material must have a yield stress.
  PlasticProcess(const ElasticModel<3>& model, std::unique_ptr<ElasticitySolver<3>> solver,
                 const LayerGroups& groups, BlockSolver blocks, int lanes = widest_block);
  ~PlasticProcess() override;

  /// Simulates until sweeps change the displacements by at most SolveTolerance::flow_change(). Throws
  /// NumericalError if the sweeps do not converge. Inherent strains count where there are no temperatures.
  const ProcessResult& simulate(const ProcessInput<3>& input) override;
  /// Solves an adjoint for each functional. Throws NumericalError if its sweeps do not converge.
  void pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                 std::span<const ProcessDerivatives> derivatives) override;
  std::vector<double> release_displacement(const LayerDensities&, const ReleaseSolver&) const override {
    return result_.release;
  }
  LockedIn locked_in(const LayerDensities&) const override { return built_; }
  LockedIn released(LockedIn, std::span<const double>) const override { return released_; }
  void set_tolerance(const SolveTolerance& tolerance) override { tolerance_ = tolerance; }
  void release_memory() override;
  /// Later simulations begin from zero displacements.
  void start_cold() override;
  std::string description() const override;

 private:
  void add_weight_derivatives(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                              std::span<const ProcessDerivatives> derivatives) const;
  void keep_adjoints(std::size_t functionals);
  /// Later simulations and adjoints begin from zero.
  void forget();

  std::unique_ptr<PlasticSweeps> forward_;  ///< that have found the last result
  std::vector<std::vector<LaneVector>>
      adjoints_;  ///< of the last functionals, [functional][wave]; empty: not kept
  SolveTolerance tolerance_;
  LockedIn built_, released_;
};

}  // namespace fabseq
