// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"

#include <span>
#include <vector>

namespace fabseq {

/// What heat conduction through the layers leads to (docs/formulation.md 14.2). The same on all copies of a
/// rank.
struct LayerTemperatures {
  std::vector<double> interpass;    ///< B_j at which each layer begins, degrees Celsius, [layer]
  std::vector<double> share;        ///< s_j of the inherent strain that each layer gets, [layer]
  std::vector<double> share_slope;  ///< d(share)/dB_j, 1/K, [layer]

  // Excesses over the air, K, at these nodes of the rank, which are those of ThermalModel.
  std::span<const int> nodes;
  std::vector<double> start;                                  ///< before the first layer
  std::vector<std::vector<std::vector<double>>> after_steps;  ///< [layer][step][one of `nodes`]
  std::vector<int> iterations;                                ///< of each layer's solves, their sum

  /// What conducts heat in each eight of layers (StandingElements); empty: all elements.
  std::vector<std::vector<double>> regions;

  int count() const { return static_cast<int>(interpass.size()); }
  /// ThermalModel::layer()'s region of a layer.
  std::span<const double> region(int layer) const {
    return regions.empty() ? std::span<const double>() : std::span(regions[layer / widest_block]);
  }
  /// Returns the excesses before a step of a layer.
  const std::vector<double>& before(int layer, std::size_t step) const {
    if (step > 0) return after_steps[layer][step - 1];
    return layer > 0 ? after_steps[layer - 1].back() : start;
  }
  /// Returns the excesses at the end of a layer's pause.
  const std::vector<double>& at_end(int layer) const { return after_steps[layer].back(); }
};

}  // namespace fabseq
