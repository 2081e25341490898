// SPDX-License-Identifier: MIT
#pragma once

#include "cg/lane_cg.h"
#include "cg/lane_outcome.h"
#include "fabseq/grid/grid.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/solve/heat_solver.h"
#include "kernels/lane_array.h"
#include "multigrid/lane_layout.h"
#include "solve/first_guess.h"
#include "solve/reference/reference_heat.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace fabseq {

/// Flexible conjugate gradients with lane multigrid, one right-hand side per lane. Right-hand sides that do
/// not converge are solved again by the reference path, with a warning. If the operator or a right-hand side
/// holds what is no number, its report says so at once.
template <int Dim>
class LaneHeat : public HeatSolver<Dim> {
 public:
  /// `lanes`: the most in a block; below `widest_block` the solver saves memory, and it does without
  /// LaneCycle::narrows. The grid and `domain` must outlive the solver. `lumped`: the mass
  /// matrix is diagonal. `reference`: settings of the fallback, whose tolerance is the lanes', too.
  /// Collective.
  LaneHeat(const Grid<Dim>& grid, const SystemDomain& domain, bool lumped, int max_iterations,
           const AssembledSolverSettings& reference, int lanes = widest_block,
           const LaneCycle& cycle = LaneHeat::cycle());

  using HeatSolver<Dim>::set_operator;
  void set_operator(const HeatOperator& of) override;
  std::vector<SolveReport> solve(std::span<const LaneVector> loads,
                                 std::span<LaneVector> solutions) override {
    return solve_from(FirstGuess::zero, loads, solutions);
  }
  std::vector<SolveReport> improve(std::span<const LaneVector> loads,
                                   std::span<LaneVector> solutions) override {
    return solve_from(FirstGuess::given, loads, solutions);
  }
  void set_tolerance(const SolveTolerance& tolerance) override;
  void start_cold() override;
  void release_memory() override;
  bool saves_memory() const override { return most_lanes_ < widest_block; }
  static LaneCycle cycle();
  /// Returns the cycle for steps in time: a V-cycle, and more for lanes that take long. The capacity, which
  /// grows with the diffusivity, makes thin sheets and soft surroundings easy.
  static LaneCycle cycle_of_steps();

 private:
  std::vector<SolveReport> solve_from(FirstGuess guess, std::span<const LaneVector> loads,
                                      std::span<LaneVector> solutions);
  std::vector<SolveReport> solve_block(FirstGuess guess, const LaneVector& load, LaneVector& solution);
  /// Fills in the operator and sets up the solver of a width.
  template <int Width>
  void set_up(LaneCg<LaneHeatProblem<Dim>, Width>& solver);
  std::vector<double> reaction_with_diagonal() const;
  HeatOperator current() const { return {diffusivity_, reaction_, diagonal_}; }
  void solve_again(std::span<const LaneVector> loads, std::span<LaneVector> solutions,
                   std::vector<SolveReport>& reports);
  /// The reference path with the current operator.
  ReferenceHeat<Dim>& fallback();

  const Grid<Dim>& grid_;
  const SystemDomain& domain_;
  bool lumped_;
  LaneHeatProblem<Dim> problem_;
  AssembledSolverSettings reference_settings_;
  LaneStop stop_;
  LaneHierarchy<Dim> hierarchy_;
  LaneLayout<Dim> layout_;
  LaneCg<LaneHeatProblem<Dim>, widest_block> solver_;
  int most_lanes_;
  std::vector<std::int64_t> numbers_;                      ///< of the domain's elements in the mesh
  std::vector<double> diffusivity_, reaction_, diagonal_;  ///< of the current operator
  bool has_diagonal_ = false;                              ///< on any rank: this one may have no elements
  std::vector<double> smeared_reaction_;  ///< reaction that stands for the diagonal, too, if there is one
  bool finite_ = true;                    ///< whether all of the operator are numbers
  std::array<bool, widest_block + 1> is_set_up_{};  ///< for each width whether its solver has the operator
  LaneArray load_, solution_;                       ///< on the mesh
  std::unique_ptr<ReferenceHeat<Dim>> fallback_;    ///< made at first use
  bool fallback_is_set_up_ = false;
};

}  // namespace fabseq
