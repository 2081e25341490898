// SPDX-License-Identifier: MIT
/// \file
/// What goes back through the stages of the pipeline.
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/process_adjoint.h"
#include "fabseq/sequence/sequence.h"

#include <algorithm>
#include <vector>

namespace fabseq {

/// How derivatives of a row with respect to a stage's results are held. Rows that use displacements are begun
/// by all groups alike, and each group adds what its steps lead to; the row's owner goes on alone. Each type
/// of derivatives has what it does otherwise than this one: every group needs all, and there is nothing to
/// sum up.
struct HeldByAll {
  /// Forgets what groups other than the owner have begun with.
  void drop() {}
  /// Forgets what is the same on all ranks of a group, on ranks other than its first.
  void keep_once() {}
  /// Sums up the groups' parts at the owner. Collective on LayerGroups::across().
  void sum_at(const LayerGroups& /*groups*/, int /*owner*/) {}
};

/// dJ/du, dJ/dv and dJ/d(increments) for the strain as given, of whose increments each group has its own;
/// empty while zero.
struct ProcessFunctionals : ProcessAdjoint, HeldByAll {
  std::vector<ProcessAdjoint> combinations;  ///< the same for combinations of strain cases
};

/// Derivatives with respect to the inputs of the strains (StrainSource), this rank's part of the sum over all
/// ranks; empty while zero.
struct StrainDerivatives : HeldByAll {
  std::vector<double> inputs;

  void drop() { inputs.clear(); }
};

/// Derivatives with respect to temperatures, this rank's part of the sum over all ranks; empty while zero.
struct TemperatureDerivatives {
  std::vector<double> interpass;  ///< at which layers begin, [layer]
  /// Excesses at the end of deposition and of the pause, [layer][these two][owned node].
  std::vector<double> ends;

  std::vector<double>& zeros_if_empty(int layers) {
    return DensityDerivatives::zeros_if_empty(interpass, static_cast<std::size_t>(layers));
  }
  void drop() {
    interpass.clear();
    ends.clear();
  }
  void keep_once() { std::ranges::fill(interpass, 0.0); }
  /// Leaves nothing in other groups than the owner.
  void sum_at(const LayerGroups& groups, int owner) {
    for (std::vector<double>* values : {&interpass, &ends}) {
      if (values->empty()) continue;
      groups.sum_at(owner, *values);
      if (groups.index() != owner) values->clear();
    }
  }
};

/// Derivatives with respect to stage and layer densities, time points, sub-parts and directions. The layers
/// take them from each group (DensitySink).
struct LayerDerivatives : DensityDerivatives, HeldByAll {
  using DensityDerivatives::DensityDerivatives;
  void drop() {
    static_cast<DensityDerivatives&>(*this) = DensityDerivatives(static_cast<int>(stage.size()));
  }
  void keep_once() { time_points.clear(); }
};

/// Derivatives with respect to t and grad t; empty while zero.
struct SequenceDerivatives : TimeDerivatives, HeldByAll {
  bool gradient_in_parts = false;  ///< whether all groups have parts of that with respect to grad t

  void drop() { static_cast<TimeDerivatives&>(*this) = {}; }
  void sum_at(const LayerGroups& groups, int owner) {
    groups.sum_at(owner, time);
    if (gradient_in_parts) groups.sum_at(owner, gradient);
  }
};

/// Derivatives of one row (a weighted sum of response components) with respect to the result of each stage.
/// Responses add theirs to it, and so does each stage to those of the stages before it.
template <int Dim>
struct StageDerivatives {
  explicit StageDerivatives(int layers) : densities(layers) {}

  ProcessFunctionals process;
  StrainDerivatives strains;
  TemperatureDerivatives temperatures;
  LayerDerivatives densities;
  SequenceDerivatives time;

  /// Calls f(member) for each of them.
  template <class Function>
  void for_each(Function&& f) {
    f(process);
    f(strains);
    f(temperatures);
    f(densities);
    f(time);
  }
};

}  // namespace fabseq
