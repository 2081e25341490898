/// \file
/// Residual stress after the last layer, and the release from the plate (docs/formulation.md 4.3).
#pragma once

#include "fabseq/process/process_simulation.h"

#include <vector>

namespace fabseq {

/// sigma = sum_j [E_j C B du_j - (drho_j)^q E_0 C eps*] at the centres of the model's elements, [owned
/// element][Voigt], stress unit, 0 outside the model. For the simulation's last result. Collective.
template <int Dim>
std::vector<double> residual_stress(const ProcessSimulation<Dim>& simulation,
                                    const LayerDensities& densities);

/// Forces of the plate on the part over all layers, sum_j (K_j du_j - f_j) on the plate's nodes, [owned
/// node][component], 0 elsewhere, for unit Young's modulus. They balance themselves. Collective.
template <int Dim>
std::vector<double> plate_reactions(const ProcessSimulation<Dim>& simulation,
                                    const LayerDensities& densities);

/// Displacement increment when the plate lets go: the finished part under minus the reactions, mean
/// translation and rotation of the plate's nodes removed by least squares; [owned node][component]. Throws
/// InputError if the plate's nodes cannot hold the part against every rigid motion. Collective.
template <int Dim>
std::vector<double> release_displacement(const ProcessSimulation<Dim>& simulation,
                                         const LayerDensities& densities,
                                         const AssembledSolverSettings& solver);

}  // namespace fabseq
