// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/release.h"
#include "fabseq/process/step_systems.h"
#include "process/plastic_batches.h"
#include "process/plastic_exchange.h"
#include "process/plastic_history.h"
#include "process/plastic_iteration.h"
#include "process/plastic_material.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// What a process leaves in the model's elements: stress for unit Young's modulus, [element][Voigt], and
/// equivalent plastic strain.
struct PlasticState {
  std::vector<double> stress, plastic_strain;
};

/// The displacements of all steps of a plastic process, found wave by wave (docs/formulation.md 16). The
/// unknowns of a wave are, of this group's block, the increments of the steps; where the modulus follows the
/// temperature, their sums from the wave's first step on. Collective on the world of the groups.
class PlasticSweeps {
 public:
  /// `systems` have been dealt out in turn. `release`: nullptr: there is none. References must outlive the
  /// object.
  PlasticSweeps(StepSystems<3>& systems, Release<3>* release, const PlasticInput& input);
  PlasticSweeps(const PlasticSweeps&) = delete;  // members refer to members
  PlasticSweeps& operator=(const PlasticSweeps&) = delete;

  /// Gives the unknowns of all waves away.
  std::vector<LaneVector> take_unknowns() { return std::move(unknowns_); }
  /// Begins with the unknowns of other sweeps, if they fit.
  void start_from(std::vector<LaneVector> unknowns);
  /// Unknowns of all waves, zero; and whether those of others are of as many steps.
  std::vector<LaneVector> zero_unknowns() const;
  bool fits(const std::vector<LaneVector>& unknowns) const;
  /// Iterates all waves to this change (PlasticIteration::solve()). Returns the number of sweeps of each
  /// step. Throws NumericalError if there would be too many.
  std::vector<int> run(double change);

  /// Increments of the steps of this group's blocks, on the model's nodes.
  std::vector<LaneVector> increments() const;
  /// Displacement of the release, [owned node][component]; empty: there is none.
  std::vector<double> release() const;
  PlasticState built() const { return state(starts_[step_waves()]); }
  PlasticState released() const { return state(starts_.back()); }

  // What adjoints need.
  const PlasticInput& input() const { return input_; }
  const std::vector<PlasticWave>& waves() const { return waves_; }
  const LaneVector& unknowns(std::size_t wave) const { return unknowns_[wave]; }
  /// States of the batches before a wave.
  const std::vector<PlasticPoint>& start(std::size_t wave) const { return starts_[wave]; }
  const PlasticExchange& exchange() const { return exchange_; }
  const PlasticHistory& history() const { return history_; }
  PlasticIteration& iteration() { return iteration_; }
  /// Makes a wave the current one of material and systems.
  void set_wave(std::size_t wave, bool changed);
  /// Gives back what the next waves can do without.
  void save_memory() {
    systems_.save_memory();
    exchange_.release_memory();
    iteration_.release_memory();
  }
  /// Interpolated stiffness around each owned node in the steps of this group's block, without temperatures.
  LaneVector nodal_stiffness(const PlasticWave& wave) const;
  const LayerGroups& groups() const { return systems_.groups(); }

 private:
  std::size_t step_waves() const { return waves_.size() - (waves_.back().release ? 1 : 0); }
  void go_through(std::size_t wave, const LaneVector& unknowns, LaneVector* forces,
                  std::vector<PlasticPoint>* behind) const;
  PlasticState state(const std::vector<PlasticPoint>& points) const;

  StepSystems<3>& systems_;
  PlasticInput input_;
  PlasticBatches batches_;
  PlasticExchange exchange_;
  PlasticMaterial material_;
  PlasticHistory history_;
  PlasticIteration iteration_;
  std::vector<PlasticWave> waves_;
  std::vector<LaneVector> unknowns_;               ///< of each wave
  std::vector<std::vector<PlasticPoint>> starts_;  ///< before each wave, and behind the last one, by batch
};

}  // namespace fabseq
