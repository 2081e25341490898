// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/solve/heat_solver.h"
#include "fabseq/thermal/thermal_model.h"

#include <span>

namespace fabseq {

/// Finds the pauses of TemperatureSimulation::needed_pauses(): sets the entry of every layer in `seconds`,
/// negative where no pause is long enough, and returns the time of welding in all. Behind a layer without a
/// pause that is long enough, the process's pause stands. Collective on the grid's communicator.
template <int Dim>
double find_pauses(const ThermalModel<Dim>& model, HeatSolver<Dim>& solver, const SolveTolerance& tolerance,
                   const LayerDensities& densities, double limit, std::span<double> seconds);

}  // namespace fabseq
