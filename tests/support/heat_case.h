// SPDX-License-Identifier: MIT
/// \file
/// Heat sequences, their solvers, and derivatives to pull back through them.
#pragma once

#include "sequence/heat_sequence.h"
#include "solve/lane_heat.h"
#include "solve/reference/reference_heat.h"
#include "support/small_parts.h"

#include <memory>
#include <utility>
#include <vector>

namespace fabseq::test {

inline const AssembledSolverSettings exact_heat = {ReferenceMethod::direct, 1e-13, 1000, "heat_"};

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> exact_heat_solver(const Grid<Dim>& grid, const SystemDomain& domain,
                                                   bool lumped, SolverPath path) {
  if (path == SolverPath::lanes)
    return std::make_unique<LaneHeat<Dim>>(grid, domain, lumped, 100, exact_heat);
  return std::make_unique<ReferenceHeat<Dim>>(grid, domain, lumped, exact_heat);
}

/// A sequence that solves to rounding.
template <int Dim>
HeatSequence<Dim> heat_sequence(const Part<Dim>& part, const HeatSettings& settings,
                                double target_gradient = 0.0, SolverPath path = SolverPath::reference) {
  auto model = std::make_unique<const HeatModel<Dim>>(part, settings);
  auto solver = exact_heat_solver<Dim>(part.grid(), model->domain, model->lumped, path);
  return {part, settings, target_gradient, std::move(model), std::move(solver)};
}

inline HeatSettings heat_settings(MassRule mass, double filter_radius = 0.0) {
  HeatSettings result;
  result.mass = mass;
  result.filter_radius = filter_radius;
  result.drain = 0.7;
  result.characteristic_length = 1.3;
  result.min_diffusivity = 0.02;
  result.void_diffusivity = 0.01;
  return result;
}

/// Linear functionals: of t alone, of grad t alone, then of both.
template <int Dim>
std::vector<TimeDerivatives> time_functionals(const Part<Dim>& part, int count) {
  std::vector<TimeDerivatives> rows(count);
  const std::size_t elements = part.elements().size();
  for (int row = 0; row < count; ++row) {
    rows[row].time = row == 1 ? std::vector<double>(elements, 0.0) : noise_field(part, -1.0, 1.0, 10 + row);
    if (row == 0) continue;
    rows[row].gradient.resize(elements * Dim);
    for (int a = 0; a < Dim; ++a) {
      const auto component = noise_field(part, -1.0, 1.0, 20 + 5 * row + a);
      for (std::size_t e = 0; e < elements; ++e) rows[row].gradient[e * Dim + a] = component[e];
    }
  }
  return rows;
}

}  // namespace fabseq::test
