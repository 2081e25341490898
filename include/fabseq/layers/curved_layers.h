// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"

#include <span>
#include <vector>

namespace fabseq {

/// T_j = j / count: T_0 = 0 ... T_N = 1.
std::vector<double> uniform_time_points(int count);
/// T_1 ... T_{N-1} of `count` layers at equal steps between the given T_1 ... T_{M-1}: the same for as many
/// layers, uniform ones if none are given.
std::vector<double> interpolated_time_points(std::span<const double> given, int count);

/// Layers between isosurfaces of the pseudo-time (docs/formulation.md 3.1), by the smooth (or binary) step
/// between stages. Its variables are T_1 ... T_{N-1}. No call is collective.
class CurvedLayers : public Layers {
 public:
  /// `density`: of the part elements; not owned, must outlive the object. `time_points`: T_0 = 0 ... T_N = 1.
  /// `binary`: the step function instead of the smooth one.
  CurvedLayers(std::span<const double> density, std::vector<double> time_points, double beta, bool binary);

  int count() const { return static_cast<int>(time_points_.size()) - 1; }

  void set_densities(std::span<const double> time, LayerDensities& densities) const override;
  void pull_back(std::span<const double> time, const LayerDensities& densities,
                 const DensityDerivatives& derivatives, std::span<double> d_time,
                 std::span<double> d_variables) const override;
  /// The first layer whose time point is not earlier.
  std::vector<double> layer_index(std::span<const double> time,
                                  const LayerDensities& densities) const override;

 private:
  /// Takes from `stage` what is built after a time point.
  void apply_step(std::span<const double> time, double time_point, std::span<double> stage) const;
  void pull_back_steps(std::span<const double> time, const DensityDerivatives& derivatives,
                       std::span<double> d_time, std::span<double> d_variables) const;

  std::span<const double> density_;
  std::vector<double> time_points_;
  double beta_;
  bool binary_;
};

}  // namespace fabseq
