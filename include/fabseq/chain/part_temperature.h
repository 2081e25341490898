// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/model/model.h"
#include "fabseq/thermal/temperature_simulation.h"

namespace fabseq {

/// The temperature simulation that a model with a block `thermal` asks for.
template <int Dim>
struct PartTemperature {
  /// `tolerance`: of the run; steps are solved ten times closer. The model must outlive the object.
  /// Collective on the grid's communicator.
  PartTemperature(const Model<Dim>& model, double tolerance);
  PartTemperature(PartTemperature&&) = delete;  // the simulation refers to its model

  ThermalModel<Dim> thermal;
  TemperatureSimulation<Dim> simulation;
};

}  // namespace fabseq
