// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/pipeline.h"
#include "fabseq/machine/marked_elements.h"
#include "fabseq/machine/time_gradient.h"

#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// What findings measure: a pseudo-time cut into binary layers, for checks with the directions in which these
/// grow; and for reports the run of a pipeline that it comes from. References must outlive it.
template <int Dim>
struct MeasuredSequence {
  const Model<Dim>& model;
  const PseudoTime<Dim>& time;
  const LayerDensities& layers;  ///< for checks only time points, sub-parts and the number of layers count
  std::vector<double> layer_index = {};      ///< the layer of each part element, from 1
  TimeGradient gradient = {};                ///< find_direction() sets it, and the next two
  std::vector<double> direction = {};        ///< build_direction()
  std::vector<double> axis = {};             ///< torch_axis()
  const Pipeline<Dim>* pipeline = nullptr;   ///< null: layers that no pipeline has run with
  const StageResults<Dim>* state = nullptr;  ///< of its last run; null with the pipeline
  bool with_shape = false;                   ///< whether it is for a full report
  int used_layers = 0;                       ///< for full reports: layers with more than a trace of volume

  /// Finds out how the layers grow and how the torch stands, which the checks need. Collective.
  void find_direction();
  const ModelSettings& settings() const { return model.settings; }
  const Part<Dim>& part() const { return model.part; }
  /// Counts elements with a mark > 0, a part field. Collective.
  MarkedElements count(std::span<const double> marks, MarkedPlace place) const {
    return count_marked<Dim>(model.part, marks, layer_index, layers.count(), place);
  }
};

}  // namespace fabseq
