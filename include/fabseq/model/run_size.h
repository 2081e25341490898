// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/model/model_settings.h"
#include "fabseq/responses/response.h"

namespace fabseq {

/// What memory and time of a run follow from.
struct RunSize {
  double unknowns = 0.0;       ///< of one layer's system
  double nodes = 0.0;          ///< of the box
  double part_elements = 0.0;  ///< all ranks
  int dimension = 3;
  int layers = 0;
  int ranks = 1;
  int cases = 1;                   ///< strains that each layer is solved for
  double solid_nodes = 0.0;        ///< of part and substrate
  double temperature_steps = 0.0;  ///< of heat conduction through all layers; 0 without it
  bool curved_heat = false;        ///< whether conduction and storage of heat depend on the temperature
  int flow_steps = 0;              ///< of the process where the material flows; 0: it does not
  bool warm = false;               ///< whether solves begin with the last solutions, which are kept
  int functionals = 0;  ///< residuals of least squares, scenarios of the worst: each costs an elastic adjoint
  double cores_per_rank = 1.0;  ///< at most 1 (NodeCores::per_rank())
};

/// RunSize::flow_steps.
int flow_steps(const ModelSettings& settings, int layers);

/// Whether the optimizer gets a term as its squares. Where the material flows each square costs an adjoint:
/// then the user has to ask for them.
template <int Dim>
bool takes_squares(const ModelSettings& settings, const SumOfSquares<Dim>& squares) {
  return settings.process.model == ProcessModel::linear || squares.asked_for;
}

/// Size of a run with this part, the responses of its objective and so many layers. Collective on the grid's
/// communicator.
template <int Dim>
RunSize run_size(const ModelSettings& settings, const Part<Dim>& part, const ResponseList<Dim>& objective,
                 int layers, int ranks);

}  // namespace fabseq
