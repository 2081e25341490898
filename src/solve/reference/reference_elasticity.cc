// SPDX-License-Identifier: MIT
#include "fabseq/solve/reference/reference_elasticity.h"

namespace fabseq {

template <int Dim>
ReferenceElasticity<Dim>::ReferenceElasticity(const Grid<Dim>& grid, const SystemDomain& domain,
                                              const SquareMatrix<element_unknowns<Dim>>& stiffness,
                                              const AssembledSolverSettings& settings)
    : domain_(domain),
      stiffness_(stiffness),
      settings_(settings),
      numbering_(std::make_shared<UnknownNumbering<Dim>>(grid, domain)),
      keep_(numbering_->count * Dim <= keep_limit) {
  settings_.method = usable_method(settings_.method, *numbering_);
}

template <int Dim>
void ReferenceElasticity<Dim>::set_operators(int first_layer, int lanes, std::span<const double> stiffness,
                                             bool changed) {
  first_layer_ = first_layer;
  lanes_ = lanes;
  coefficients_.assign(stiffness.begin(), stiffness.end());
  for (int lane = 0; changed && lane < lanes; ++lane) up_to_date_[first_layer + lane] = false;
}

template <int Dim>
AssembledSystem<Dim>& ReferenceElasticity<Dim>::assembled(int lane) {
  const int key = keep_ ? first_layer_ + lane : -1;
  auto& system = systems_[key];
  if (!system) system = std::make_unique<AssembledSystem<Dim>>(domain_, numbering_, settings_);
  if (!keep_ || !up_to_date_[key]) {
    const std::size_t elements = domain_.first_corners.size();
    std::vector<double> coefficients(elements);
    for (std::size_t e = 0; e < elements; ++e) coefficients[e] = coefficients_[e * lanes_ + lane];
    system->assemble({{stiffness_, coefficients}});
    up_to_date_[key] = true;
  }
  return *system;
}

template <int Dim>
std::vector<std::vector<SolveReport>> ReferenceElasticity<Dim>::solve(std::span<const LaneVector> loads,
                                                                      std::span<LaneVector> displacements) {
  std::vector<std::vector<SolveReport>> reports(loads.size(), std::vector<SolveReport>(lanes_));
  std::vector<std::vector<double>> load(loads.size()), displacement;
  for (const LaneVector& set : loads) displacement.emplace_back(set.unknowns());
  for (int lane = 0; lane < lanes_; ++lane) {
    for (std::size_t set = 0; set < loads.size(); ++set) load[set] = loads[set].lane(lane);
    const std::vector<SolveReport> of_lane = assembled(lane).solve(load, displacement);
    for (std::size_t set = 0; set < loads.size(); ++set) {
      reports[set][lane] = of_lane[set];
      displacements[set].set_lane(lane, displacement[set]);
    }
  }
  return reports;
}

template <int Dim>
void ReferenceElasticity<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  settings_.tolerance = tolerance.smallest();
  for (auto& [layer, system] : systems_) system->set_tolerance(settings_.tolerance);
}

/// Kept systems hold factorizations, estimates of eigenvalues, and whether their preconditioner was relaxed.
template <int Dim>
void ReferenceElasticity<Dim>::start_cold() {
  systems_.clear();
  up_to_date_.clear();
}

template <int Dim>
std::string ReferenceElasticity<Dim>::description() const {
  const auto unknowns = numbering_->count * Dim;
  const char* name = settings_.method == ReferenceMethod::direct ? "CG + Cholesky (MUMPS)"
                     : settings_.method == ReferenceMethod::multigrid
                         ? "CG + geometric multigrid (Galerkin, Chebyshev/Jacobi)"
                         : "CG + GAMG (rigid-body modes, threshold 0.01)";
  return std::string("reference path: ") + name + ", " + std::to_string(unknowns) + " unknowns a layer" +
         (keep_ ? ", systems kept" : "");
}

FABSEQ_INSTANTIATE_CLASS(ReferenceElasticity);

}  // namespace fabseq
