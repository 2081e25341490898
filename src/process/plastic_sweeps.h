// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/step_transpose.h"
#include "fabseq/process/release.h"
#include "fabseq/process/step_systems.h"
#include "process/plastic_fields.h"
#include "process/plastic_history.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// The displacements of all steps of a plastic process, and the sweeps that improve them (docs/formulation.md
/// 16). The unknowns are, of this group's blocks, the increments of the steps; where the modulus follows
/// the temperature, their sums up to the step; and the displacement of the release, if there is one.
/// Collective on the world of the groups.
class PlasticSweeps : public StepLoads {
 public:
  /// `release`: nullptr: there is none. References must outlive the object.
  PlasticSweeps(StepSystems<3>& systems, Release<3>* release, const LayerDensities& densities,
                const StrainSource<3>& strains, const StepTemperatures* temperatures);

  /// Iterates until a sweep changes the displacements by less than this share of them. Returns the number of
  /// sweeps. Throws NumericalError if there would be too many.
  int run(double tolerance);

  /// Increments of the steps of this group's blocks, on all owned nodes.
  std::vector<LaneVector> increments() const;
  /// Displacement of the release, [owned node][component]; empty: there is none.
  std::vector<double> release() const;
  /// Stress and plastic strain of this rank's share of the elements (StepTranspose).
  const PlasticState& built() const { return output_.built; }
  const PlasticState& released() const { return output_.released; }

  // What adjoints need of a state that has been found.
  const PlasticInput& input() const { return input_; }
  const PlasticFields& fields() const { return fields_; }
  const PlasticHistory& history() const { return history_; }
  const StepTranspose& elements() const { return elements_; }
  const std::vector<std::size_t>& first() const { return first_; }
  /// Displacements of this rank's share of the elements.
  PlasticHistory::Displacements displacements() const;
  /// Weights of the unknowns in products: the diagonal of the steps' stiffness, about.
  std::vector<double> product_weights() const;
  /// Scales the stiffness of a block by the modulus, where it follows the temperature.
  ScaleStiffness stiffness_scale() const;

  std::size_t begin(std::size_t block) override;
  void set(std::size_t block, std::size_t side, LaneVector& load) override;
  void take(std::size_t block, std::size_t side, LaneVector& solution) override;

 private:
  bool accumulated() const { return input_.temperatures != nullptr; }
  LaneVector of_block(std::size_t block) const;
  void find_histories();
  /// Sets the step of the sweep that follows from them.
  void find_step(bool first);
  void scale(const BlockRegion& block, std::span<double> stiffness) const;

  StepSystems<3>& systems_;
  Release<3>* release_;
  PlasticInput input_;
  PlasticFields fields_;
  PlasticHistory history_;
  StepTranspose elements_;
  std::vector<std::size_t> first_;  ///< entry of each block in the unknowns, and of the release
  std::vector<double> unknowns_, step_;
  std::vector<double> histories_, of_release_;  ///< displacements of the share, as ElementModes
  PlasticHistory::Output output_;
  std::vector<LaneVector> forces_;    ///< of this group's blocks
  std::vector<double> force_at_end_;  ///< on all owned nodes
};

}  // namespace fabseq
