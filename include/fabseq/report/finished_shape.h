// SPDX-License-Identifier: MIT
/// \file
/// What a gauge and a scan would find on the finished part.
#pragma once

#include "fabseq/chain/pipeline.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Length of the displacement of some nodes, length unit.
struct DisplacementSize {
  double largest = 0.0, rms = 0.0;
};

struct DisplacementSizes {
  DisplacementSize part;
  std::optional<DisplacementSize> nodes;  ///< of all node sets that the objective measures; none without them
};

/// A drawing that is scaled so that the skin comes nearest to its place: by which factor, and how much is
/// left of the skin's displacement, rms, length unit.
struct ScaledDrawing {
  double factor = 1.0, rms = 0.0;
};

/// How far a part is from the drawing, in length units.
struct Deviation : DisplacementSizes {
  /// Machining stock: how far the skin lies outside and inside of its place along its normal, after the best
  /// rigid fit. Both at least 0.
  double outward = 0.0, inward = 0.0;
  DisplacementSize skin;  ///< displacement of the skin after that fit
  ScaledDrawing scaled;
};

/// The part as it is built, by the deposition model of the run, and cut from its plate or clamps.
struct FinishedShape {
  Deviation as_built;
  std::optional<Deviation> released;  ///< none where a release is not defined or its solve fails
  /// Returns the deviation after the release where that is asked for and known, else as built.
  const Deviation& deviation(bool after_release) const {
    return after_release && released ? *released : as_built;
  }
  std::vector<double> release;  ///< what the release adds, [ElasticModel::nodes][component]; empty: none
  std::vector<double> released_displacement;  ///< displacement with the release, likewise
  std::string failure;                        ///< why the solve for the release failed; empty: it did not
};

/// The finished part of a pipeline's last run, with one solve for the release. Collective.
template <int Dim>
FinishedShape finished_shape(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                             const StageResults<Dim>& state);

/// Sizes of a displacement, [owned node][component]. Collective.
template <int Dim>
DisplacementSizes displacement_sizes(const Model<Dim>& model, const std::vector<double>& displacement);

}  // namespace fabseq
