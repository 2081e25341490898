// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/solve/elasticity_solver.h"
#include "solve/region_pool.h"

#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// Leaves elements out of the systems: those whose stiffness is 0 in all lanes of a block
/// (docs/formulation.md 4.8). Nodes that no other element touches stay at 0. One solver of the pool has
/// memory at a time.
template <int Dim>
class RegionElasticity : public ElasticitySolver<Dim> {
 public:
  using Pool = RegionPool<Dim, ElasticitySolver<Dim>>;

  explicit RegionElasticity(Pool pool) : pool_(std::move(pool)) {}

  void set_operators(int first_layer, int lanes, std::span<const double> stiffness, bool changed) override;
  std::vector<std::vector<SolveReport>> solve(std::span<const LaneVector> loads,
                                              std::span<LaneVector> displacements) override {
    return pool_.current().solve(loads, displacements);
  }
  std::vector<std::vector<SolveReport>> improve(std::span<const LaneVector> loads,
                                                std::span<LaneVector> displacements) override {
    return pool_.current().improve(loads, displacements);
  }
  std::size_t sets_at_once() const override { return pool_.current().sets_at_once(); }
  void set_tolerance(const SolveTolerance& tolerance) override { pool_.set_tolerance(tolerance); }
  void start_cold() override { pool_.start_cold(); }
  void release_memory() override { pool_.release_memory(); }
  bool saves_memory() const override { return pool_.whole().saves_memory(); }
  std::string description() const override { return pool_.whole().description(); }

 private:
  Pool pool_;
};

}  // namespace fabseq
