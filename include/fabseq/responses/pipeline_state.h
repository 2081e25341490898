// SPDX-License-Identifier: MIT
/// \file
/// What goes forward and back through the stages of the pipeline, by the names of their results.
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/process/elastic_process.h"
#include "fabseq/process/process_adjoint.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/thermal/layer_temperatures.h"

#include <vector>

namespace fabseq {

/// The results of the pipeline's stages for one design, which the pipeline owns.
template <int Dim>
struct PipelineState {
  const PseudoTime<Dim>& time;
  const LayerDensities& layers;
  const ProcessResult& process;
  const LayerTemperatures* temperatures = nullptr;  ///< null: the strain does not follow the temperature
};

/// Derivatives of one row (a weighted sum of response components) with respect to the result of each stage.
/// Responses add theirs to it, and so does each stage to those of the stages before it.
template <int Dim>
struct PipelineAdjoint {
  explicit PipelineAdjoint(int layers) : densities(layers) {}

  ProcessAdjoint process;  ///< dJ/du, dJ/dv and dJ/d(increments) for the strain as given; empty while zero
  std::vector<ProcessAdjoint> combinations;  ///< the same for combinations of strain cases
  std::vector<double>
      strains;  ///< by the inputs of the strains (StrainSource), this rank's part; empty while zero
  /// By the temperatures at which layers begin, [layer], this rank's part of the sum over all ranks; empty
  /// while zero.
  std::vector<double> interpass;
  DensityDerivatives densities;  ///< by stage and layer densities, time points, sub-parts and directions
  TimeDerivatives time;          ///< by t and grad t; empty while zero

  std::vector<double>& interpass_or_zeros(int layers) {
    return DensityDerivatives::zeros_if_empty(interpass, static_cast<std::size_t>(layers));
  }
};

}  // namespace fabseq
