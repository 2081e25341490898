// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/solve/heat_solver.h"
#include "solve/region_pool.h"

#include <utility>
#include <vector>

namespace fabseq {

/// Leaves elements out of the systems: those without diffusivity (docs/formulation.md 4.8). Nodes that no
/// other element touches stay at 0.
template <int Dim>
class RegionHeat : public HeatSolver<Dim> {
 public:
  using Pool = RegionPool<Dim, HeatSolver<Dim>>;

  explicit RegionHeat(Pool pool) : pool_(std::move(pool)) {}

  void set_operator(const HeatOperator& of) override;
  std::vector<SolveReport> solve(std::span<const LaneVector> loads,
                                 std::span<LaneVector> solutions) override {
    return pool_.current().solve(loads, solutions);
  }
  std::vector<SolveReport> improve(std::span<const LaneVector> loads,
                                   std::span<LaneVector> solutions) override {
    return pool_.current().improve(loads, solutions);
  }
  void set_tolerance(const SolveTolerance& tolerance) override { pool_.set_tolerance(tolerance); }
  void start_cold() override { pool_.start_cold(); }
  void release_memory() override { pool_.release_memory(); }
  bool saves_memory() const override { return pool_.whole().saves_memory(); }

 private:
  Pool pool_;
};

}  // namespace fabseq
