// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/deposition.h"
#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/release.h"
#include "fabseq/process/step_systems.h"
#include "fabseq/process/step_temperatures.h"
#include "fabseq/process/strain_source.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// What is simulated. Strains and temperatures must stay as they are while the result is used.
template <int Dim>
struct ProcessInput {
  const LayerDensities& densities;
  const StrainSource<Dim>& strains;
  std::vector<BuildStep> steps;
  const StepTemperatures* temperatures = nullptr;  ///< null: the process has one temperature
};

/// What flow and cooling leave in the part: stress and, where the material flows, equivalent plastic strain.
struct LockedIn {
  std::vector<double> stress;          ///< [owned element][Voigt], stress unit, 0 outside the model
  std::vector<double> plastic_strain;  ///< [owned element]; empty: the material does not flow
};

/// A simulation of the steps in which a part is built, and its adjoint (docs/formulation.md 4, 16): densities
/// and strains to displacements.
///
/// Layer groups share the steps; a deal holds from simulate() to the next. All calls are collective on the
/// world of the groups, and errors are thrown on all of its ranks, unless a call says otherwise.
template <int Dim>
class Process {
 public:
  /// `lanes`: steps solved side by side at most. `blocks`: how the solver goes through a block of them. Model
  /// and groups must outlive the process.
  Process(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
          const LayerGroups& groups, BlockSolver blocks, int lanes);
  virtual ~Process() = default;
  Process(const Process&) = delete;  // results refer to members
  Process& operator=(const Process&) = delete;

  /// Lets later simulations end with the release from the supports. Throws InputError if there is none
  /// (release_obstacle()).
  void release_with(const ReleaseSolver& solver) {
    release_ = std::make_unique<Release<Dim>>(model(), solver);
  }
  /// Simulates all steps; the result stays valid until the next call. Throws NumericalError if a solve does
  /// not converge, naming its layer.
  virtual const ProcessResult& simulate(const ProcessInput<Dim>& input) = 0;
  /// Adds the derivatives of several functionals at the last simulated densities and strains, with respect to
  /// the densities of this group's steps and to the inputs of the strains, as far as they enter its steps.
  /// Functionals solved together share the systems.
  virtual void pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                         std::span<const ProcessDerivatives> derivatives) = 0;
  /// Displacement that the release adds to the last simulation, [owned node][component]; `solver` finds it
  /// where the simulation had none.
  virtual std::vector<double> release_displacement(const LayerDensities& densities,
                                                   const ReleaseSolver& solver) const = 0;
  /// What the last simulation leaves before the release (docs/formulation.md 4.3).
  virtual LockedIn locked_in(const LayerDensities& densities) const = 0;
  /// The same after it, from what it was before and the displacement that the release adds.
  virtual LockedIn released(LockedIn built, std::span<const double> release) const = 0;

  /// Increments of any step, or of any layer in all its steps, on the owned nodes, [node][component]; sent by
  /// the group that has them. `counted`: what the displacement has of them.
  std::vector<double> step_increment(int step, bool counted = false) const;
  std::vector<double> layer_increment(int layer, bool counted = false) const;
  /// A line for the log: how it is solved. Local.
  virtual std::string description() const { return systems_.solver_description(); }
  /// Gives back the memory of the last simulation's increments and of the solver; what needs increments needs
  /// a further simulation. Not collective.
  virtual void release_memory();
  /// Sets the tolerance of later simulations and adjoints.
  virtual void set_tolerance(const SolveTolerance& tolerance);
  /// Forgets what earlier solves have left in the solvers for later ones.
  virtual void start_cold();
  /// Result of the last simulation, for CountedAs. Local.
  ProcessResult& result() { return result_; }
  /// Strains of the last simulation, as given. Local.
  const StrainSource<Dim>& strains() const { return *strains_; }
  /// Iterations of the adjoint solves of the last pull_back(), the largest of its functionals for each step.
  /// Local.
  const std::vector<int>& adjoint_iterations() const { return adjoint_iterations_; }
  /// The systems, for what is to be said of their solves. Local.
  StepSystems<Dim>& systems() { return systems_; }
  const StepSystems<Dim>& systems() const { return systems_; }
  const LayerGroups& groups() const { return systems_.groups(); }
  const ElasticModel<Dim>& model() const { return systems_.model(); }

 protected:
  StepSystems<Dim> systems_;
  std::unique_ptr<const Deposition<Dim>> deposition_;  ///< nullptr: all of the increments counts
  std::unique_ptr<Release<Dim>> release_;              ///< if asked for
  const StrainSource<Dim>* strains_ = nullptr;         ///< of the last simulation
  ProcessResult result_;
  std::vector<int> adjoint_iterations_;
};

}  // namespace fabseq
