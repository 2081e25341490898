// SPDX-License-Identifier: MIT
#include "fabseq/chain/part_temperature.h"

#include "fabseq/solve/solvers.h"

namespace fabseq {

template <int Dim>
PartTemperature<Dim>::PartTemperature(const Model<Dim>& model, double tolerance)
    : thermal(model.part, {model.settings.thermal.value(), model.settings.material, model.settings.process}),
      simulation(thermal,
                 make_temperature_solver(model.solver, model.grid, thermal.domain, tolerance, model.lanes),
                 step_tolerance({tolerance}), model.groups, model.lanes) {}

FABSEQ_INSTANTIATE_STRUCT(PartTemperature);

}  // namespace fabseq
