// SPDX-License-Identifier: MIT
/// \file
/// Temperatures of a simulation as the steps of a process take them (docs/formulation.md 16).
#pragma once

#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/step_temperatures.h"
#include "fabseq/responses/stage_derivatives.h"
#include "fabseq/thermal/layer_temperatures.h"
#include "fabseq/thermal/thermal_settings.h"

#include <vector>

namespace fabseq {

/// The steps of layers whose temperature is known: for each layer the end of its deposition, and the end of
/// its pause if there is one; then cooling to the air's temperature. Local.
std::vector<BuildStep> steps_of_heated_layers(int layers, const ThermalProperties& properties);

/// Temperatures of the model's elements at the end of these steps: means over their nodes. Collective on the
/// grid's communicator.
template <int Dim>
StepTemperatures step_temperatures(const ElasticModel<Dim>& model, const ThermalProperties& properties,
                                   const LayerTemperatures& temperatures,
                                   const std::vector<BuildStep>& steps);

/// Adds the derivative with respect to the excesses that follows from that with respect to these
/// temperatures. `derivative`: [step][element of the model]. Collective on the grid's communicator.
template <int Dim>
void add_end_derivatives(const ElasticModel<Dim>& model, const std::vector<BuildStep>& steps,
                         const std::vector<std::vector<double>>& derivative, TemperatureDerivatives& to);

}  // namespace fabseq
