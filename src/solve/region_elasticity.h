// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/solve/elasticity_solver.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Leaves elements out of the systems: those whose stiffness is 0 in all lanes of a block. Nodes that no
/// other element touches stay at 0. The block has a solver of its own for the elements that are left, which
/// is kept from forward to adjoint, and to the next simulation if that leaves the same elements.
template <int Dim>
class RegionElasticity : public ElasticitySolver<Dim> {
 public:
  /// Makes a solver for a domain, which outlives it. Collective.
  using Make = std::function<std::unique_ptr<ElasticitySolver<Dim>>(const SystemDomain&)>;

  /// `domain`: of all elements; as the grid, it must outlive the solver. Collective.
  RegionElasticity(const Grid<Dim>& grid, const SystemDomain& domain, Make make);

  void set_operators(int first_layer, int lanes, std::span<const double> stiffness, bool changed) override;
  std::vector<std::vector<SolveReport>> solve(std::span<const LaneVector> loads,
                                              std::span<LaneVector> displacements) override {
    return current_->solve(loads, displacements);
  }
  std::size_t sets_at_once() const override { return current_->sets_at_once(); }
  void set_tolerance(const SolveTolerance& tolerance) override;
  void start_cold() override;
  void give_back_memory() override;
  bool saves_memory() const override { return whole_->saves_memory(); }
  std::string description() const override { return whole_->description() + ", what is built only"; }

 private:
  /// Of a block of layers.
  struct Region {
    int lanes = 0;
    std::vector<int> elements;  ///< that are left, in the whole domain
    SystemDomain domain;
    std::unique_ptr<ElasticitySolver<Dim>> solver;
  };
  Region& region_of(int first_layer, int lanes, std::vector<int> elements);
  void use(ElasticitySolver<Dim>& solver);

  const Grid<Dim>& grid_;
  const SystemDomain& domain_;
  Make make_;
  std::optional<SolveTolerance> tolerance_;
  std::unique_ptr<ElasticitySolver<Dim>> whole_;
  std::map<int, Region> regions_;  ///< by the first layer of the block
  ElasticitySolver<Dim>* current_;
};

}  // namespace fabseq
