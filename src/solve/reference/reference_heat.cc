// SPDX-License-Identifier: MIT
#include "solve/reference/reference_heat.h"

namespace fabseq {

template <int Dim>
ReferenceHeat<Dim>::ReferenceHeat(const Grid<Dim>& grid, const SystemDomain& domain, bool lumped,
                                  const AssembledSolverSettings& settings)
    : element_(grid.spacing(), grid.domain().thickness, 0.0),
      lumped_(lumped),
      settings_(settings),
      domain_(domain),
      numbering_(std::make_shared<UnknownNumbering<Dim>>(grid, domain)),
      system_(std::make_unique<AssembledSystem<Dim>>(domain_, numbering_, settings_)) {}

template <int Dim>
void ReferenceHeat<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  settings_.tolerance = tolerance.value;
  system_->set_tolerance(tolerance.value);
}

template <int Dim>
void ReferenceHeat<Dim>::start_cold() {
  system_ = std::make_unique<AssembledSystem<Dim>>(domain_, numbering_, settings_);
}

template <int Dim>
void ReferenceHeat<Dim>::set_operator(const HeatOperator& of) {
  system_->assemble({{element_.conductivity(), of.diffusivity}, {element_.mass(lumped_), of.reaction}},
                    of.diagonal);
}

template <int Dim>
std::vector<SolveReport> ReferenceHeat<Dim>::solve(std::span<const LaneVector> loads,
                                                   std::span<LaneVector> solutions) {
  std::vector<std::vector<double>> load, solution;
  for (const LaneVector& block : loads)
    for (int lane = 0; lane < block.lanes; ++lane) {
      load.push_back(block.lane(lane));
      solution.emplace_back(block.unknowns());
    }
  std::vector<SolveReport> reports = system_->solve(load, solution);
  std::size_t next = 0;
  for (LaneVector& block : solutions)
    for (int lane = 0; lane < block.lanes; ++lane) block.set_lane(lane, solution[next++]);
  return reports;
}

FABSEQ_INSTANTIATE_CLASS(ReferenceHeat);

}  // namespace fabseq
