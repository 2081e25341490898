// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/sequence/sequence.h"

#include <vector>

namespace fabseq {

/// Where the gradient that checks work with comes from.
enum class GradientSource {
  sequence,          ///< the sequence has it
  file,              ///< recorded beside the times in the file that they were read from
  differences,       ///< fitted to the times of the elements around each one
  layer_differences  ///< the same, of times that are no finer than layers: thickness is an estimate
};

/// grad t as the checks of docs/formulation.md 13.1 need it, whatever the sequence knows of it.
struct TimeGradient {
  std::vector<double> values;  ///< [part element][axis], 1/length; empty: multi-planar layers need none
  GradientSource source = GradientSource::sequence;
  /// Share of the part at which a recorded gradient points elsewhere than the times grow, the same on all
  /// ranks.
  double share_elsewhere = 0.0;
};

/// Returns the sequence's own gradient if it has one. Otherwise returns the one recorded in its file or,
/// without that, fits one to the times around each element by least squares (docs/developer/numerics.md
/// 13.1). Multi-planar layers have print directions, so nothing is fitted for them. Collective on the grid's
/// communicator.
template <int Dim>
TimeGradient time_gradient(const Part<Dim>& part, const PseudoTime<Dim>& time, const LayerDensities& layers);

}  // namespace fabseq
