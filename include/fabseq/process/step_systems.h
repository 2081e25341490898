// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/parallel/step_dealing.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/built_region.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/step_elements.h"
#include "fabseq/solve/elasticity_solver.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

class LastSolutions;
struct SolveCount;

/// Right-hand sides of the systems of a process, block by block, and where their solutions go. Vectors are on
/// all owned nodes, with a lane per step of the block. Calls are collective on the grid's communicator.
class StepLoads {
 public:
  virtual ~StepLoads() = default;
  /// Number of right-hand sides of a block, by its number; they follow at once.
  virtual std::size_t begin(std::size_t block) = 0;
  virtual void set(std::size_t block, std::size_t side, LaneVector& load) = 0;
  virtual void take(std::size_t block, std::size_t side, LaneVector& solution) = 0;
  /// Ends a block, whose sides have all been taken.
  virtual void end(std::size_t /*block*/) {}
};

/// What the systems are solved for: after a change of the densities, or for adjoints.
enum class SolvePurpose { forward, adjoint };

/// Changes the stiffness factors of the systems of a block, [element][lane].
using ScaleStiffness = std::function<void(const BlockRegion& block, std::span<double> stiffness)>;

/// The elastic systems of all steps of a process (docs/formulation.md 4.1), K_s du_s = f_s with the plate
/// fixed,
///
///     K_s = sum_e E(rho_j,e) K_0,
///
/// where j is the step's layer. They are symmetric: adjoints are solved by the same call. Layer groups share
/// the steps, in blocks that are solved side by side; the deal holds until the next deal_out(). Calls are
/// collective on the world of the groups, and errors are thrown on all of its ranks, unless a call says
/// otherwise.
template <int Dim>
class StepSystems {
 public:
  /// Right-hand sides of a block, or functionals, whose solutions are kept to begin the next ones, at most;
  /// where there are more, none are. Each takes up to the memory of the displacements.
  static constexpr int most_kept = 2;

  /// `lanes`: steps solved side by side at most. `blocks`: how the solver goes through a block of them. Model
  /// and groups must outlive the object.
  StepSystems(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
              const LayerGroups& groups, BlockSolver blocks, int lanes);
  ~StepSystems();

  /// Whether systems that are dealt out later take only what is built into account (BuiltRegion). The solver
  /// must leave out elements without stiffness then.
  void leave_out_unbuilt(bool built);
  /// Deals the steps out to the groups. The elements that count in a block are found at its first solve. Warm
  /// solves of the same number of steps keep their first deal, since a group has its own last solutions only.
  void deal_out(const LayerDensities& densities, std::vector<BuildStep> steps);
  /// The same by deal_out_in_turn().
  void deal_out_in_turn(std::vector<BuildStep> steps);
  const std::vector<BuildStep>& steps() const { return steps_; }
  const StepDeal& deal() const { return deal_; }
  /// The blocks of this group. Local.
  const std::vector<BlockRegion>& blocks() const { return blocks_; }
  /// This rank's nodes that have increments in a block, ascending; valid until the next deal_out(). Local.
  std::span<const int> nodes(std::size_t block) const {
    return blocks_[block].elements.empty() ? model_.nodes : blocks_[block].nodes;
  }
  /// Group that has a step, the block's number there, and the lane. Local.
  struct Place {
    int group = 0;
    std::size_t block = 0;
    int lane = 0;
  };
  Place place_of(int step) const;

  /// Solves the systems of this group's blocks for all their right-hand sides, as many at a time as the
  /// solver can use; the operators of a block are set up once. Returns the iterations of each step, all of
  /// them, the largest of its sides. Throws NumericalError naming the layer if a system does not converge.
  std::vector<int> solve(const LayerDensities& densities, SolvePurpose purpose, StepLoads& loads);
  /// Makes the systems of a block of this group the current ones. `changed`: whether they may differ from
  /// those that were last set for these steps. Collective on the grid's communicator.
  /// Returns their stiffness factors, [element][lane]. `scale`: changes those that follow from the densities,
  /// if given.
  std::vector<double> set_operators(const LayerDensities& densities, std::size_t block, bool changed,
                                    const ScaleStiffness& scale = {});
  /// Solves the current systems, those of `block`, for one right-hand side. Returns how each ended. Throws
  /// NumericalError naming the layer if a system does not converge, as a solve of the kind `what`. Collective
  /// on the grid's communicator.
  std::vector<SolveReport> solve_current(std::size_t block, const LaneVector& load, LaneVector& solution,
                                         const char* what);
  /// Returns a vector of any size and values, in which callers may spread solutions. It keeps its memory from
  /// solve to solve, until the solver gives its own back. Local.
  LaneVector& scratch();
  /// Gives back the solver's memory if it is to save it, until the next set_operators(). Not collective.
  void save_memory();
  /// Later systems are solved to this tolerance.
  void set_tolerance(const SolveTolerance& tolerance) {
    solver_->set_tolerance(tolerance);
    warm_ = tolerance.warm;
  }
  /// Forgets what earlier solves have left for later ones (ElasticitySolver::start_cold()).
  void start_cold();
  /// Gives back the memory of the solver and of what is kept. Not collective.
  void release_memory();
  /// The next steps are dealt out by these iterations, sums over all sides of each step: first those of the
  /// last forward solves, then those of the last adjoint ones. At first, and after a change of the number of
  /// steps, all steps count alike. Local.
  const std::vector<double>& expected_work() const { return expected_work_; }
  void set_expected_work(std::vector<double> work) { expected_work_ = std::move(work); }

  const ElasticModel<Dim>& model() const { return model_; }
  const StepElements<Dim>& elements() const { return elements_; }
  const LayerGroups& groups() const { return groups_; }
  int owned_nodes() const { return static_cast<int>(model_.part.grid().owned_nodes().count()); }
  std::string solver_description() const { return solver_->description(); }

 private:
  struct Workspace;
  void solve_block(const LayerDensities& densities, std::size_t block, SolvePurpose purpose, StepLoads& loads,
                   SolveCount& iterations);
  std::vector<std::vector<SolveReport>> solve_warm(const BlockRegion& region, SolvePurpose purpose,
                                                   std::size_t first, std::span<const LaneVector> loads,
                                                   std::span<LaneVector> solutions);
  std::vector<double> work_of(const LayerDensities& densities) const;
  void set_deal(StepDeal deal);
  std::vector<int> layers_of_steps() const;

  const ElasticModel<Dim>& model_;
  const LayerGroups& groups_;
  BlockSolver block_solver_;
  int lanes_;
  StepElements<Dim> elements_;
  std::unique_ptr<ElasticitySolver<Dim>> solver_;
  std::unique_ptr<const BuiltRegion<Dim>> built_;  ///< nullptr: all elements count
  std::vector<BuildStep> steps_;
  StepDeal deal_;
  std::vector<BlockRegion> blocks_;
  std::vector<double> expected_work_;  ///< [forward, adjoint][step]
  bool warm_ = false;
  std::optional<std::pair<std::size_t, StepDeal>> warm_deal_;  ///< number of steps of warm solves, their deal
  std::unique_ptr<LastSolutions> last_;
  std::unique_ptr<Workspace> workspace_;  ///< vectors reused from block to block and from solve to solve
};

}  // namespace fabseq
