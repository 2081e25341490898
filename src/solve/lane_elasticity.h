// SPDX-License-Identifier: MIT
#pragma once

#include "cg/lane_cg.h"
#include "cg/lane_outcome.h"
#include "fabseq/grid/grid.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/solve/elasticity_solver.h"
#include "fabseq/solve/reference/reference_elasticity.h"
#include "kernels/lane_array.h"
#include "multigrid/lane_layout.h"
#include "solve/first_guess.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fabseq {

/// Flexible conjugate gradients with lane multigrid, one layer per lane. A lane that does not converge is
/// solved again by the reference path, with a warning. If a lane holds what is no number, its report says so
/// at once.
template <int Dim>
class LaneElasticity : public ElasticitySolver<Dim> {
 public:
  /// `lanes`: the most in a block; below `widest_block` the solver saves memory, and it does without
  /// LaneCycle::narrows. The grid and `domain` must outlive the solver. `reference`: settings of
  /// the fallback, whose tolerance is the lanes', too. Collective.
  LaneElasticity(const Grid<Dim>& grid, const SystemDomain& domain, double poisson, const LaneCycle& cycle,
                 int max_iterations, const AssembledSolverSettings& reference, int lanes = widest_block);

  void set_operators(int first_layer, int lanes, std::span<const double> stiffness, bool changed) override;
  std::vector<std::vector<SolveReport>> solve(std::span<const LaneVector> loads,
                                              std::span<LaneVector> displacements) override {
    return solve_from(FirstGuess::zero, loads, displacements);
  }
  std::vector<std::vector<SolveReport>> improve(std::span<const LaneVector> loads,
                                                std::span<LaneVector> displacements) override {
    return solve_from(FirstGuess::given, loads, displacements);
  }
  void set_tolerance(const SolveTolerance& tolerance) override;
  /// The number for which there are lanes beside the layers of the block.
  std::size_t sets_at_once() const override;
  /// The lanes have operators of their own in every block; what lasts is the fallback, and what solves from a
  /// guess know of spectra.
  void start_cold() override {
    fallback_.reset();
    smallest_.clear();
  }
  void release_memory() override;
  bool saves_memory() const override { return most_lanes_ < widest_block; }
  std::string description() const override;

 private:
  std::vector<std::vector<SolveReport>> solve_from(FirstGuess guess, std::span<const LaneVector> loads,
                                                   std::span<LaneVector> displacements);
  void set_up(auto& solver, bool changed);
  void solve_sets(std::span<const LaneVector> loads, std::span<LaneVector> displacements,
                  std::span<std::vector<SolveReport>> reports, FirstGuess guess);
  void widen(std::size_t sets);
  std::vector<SolveReport> solve_lanes(const LaneVector& load, LaneVector& displacement, FirstGuess guess);
  std::vector<LaneOutcome> iterate(auto& solver, const LaneVector& displacement, int lanes, FirstGuess guess);
  void solve_again(const LaneVector& load, LaneVector& displacement, int lane, SolveReport& report);

  const Grid<Dim>& grid_;
  const SystemDomain& domain_;
  LaneElasticityProblem<Dim> problem_;
  AssembledSolverSettings reference_settings_;
  int max_iterations_;
  bool is_correction_ = false;  ///< what is left of a solve is no failure
  LaneStop stop_;
  LaneHierarchy<Dim> hierarchy_;
  LaneLayout<Dim> layout_;
  LaneCg<LaneElasticityProblem<Dim>, widest_block> solver_;
  int most_lanes_;
  std::vector<std::int64_t> numbers_;  ///< of the domain's elements in the mesh
  int first_layer_ = 0, lanes_ = 0;
  int width_ = widest_block;        ///< of the solver that is set up for the block
  int sets_ = 0;                    ///< how often it has the block's systems side by side
  std::vector<double> not_finite_;  ///< stiffness values per lane of the block that are no numbers
  std::vector<double> stiffness_;   ///< of the current block, [element][lane], for the fallback
  LaneArray load_, displacement_;
  /// Islands of the layers last set: adjoints have the operators of the solves before them.
  std::map<int, std::shared_ptr<const IslandMotions<Dim>>> islands_;
  std::map<int, double> smallest_;                      ///< LaneOutcome::smallest of the layers last solved
  std::unique_ptr<ReferenceElasticity<Dim>> fallback_;  ///< made at first use
};

}  // namespace fabseq
