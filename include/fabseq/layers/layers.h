// SPDX-License-Identifier: MIT
/// \file
/// From pseudo-time to layers, whatever their kind: which elements each stage holds and each layer adds
/// (docs/formulation.md 3).
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Added to a layer's density wherever it is a weight, so that empty layers stay finite.
constexpr double layer_density_floor = 1e-9;

/// Sub-parts that are built one after the other, each in planar layers across a direction of its own
/// (docs/formulation.md 3.2). Numbers of sub-parts begin with 0.
struct SubParts {
  std::vector<double> timestamps;            ///< tau_1 ... tau_{N_P - 1}: pseudo-times between them
  std::vector<double> directions;            ///< n_i, the print directions, [sub-part][axis], of unit length
  std::vector<std::vector<double>> density;  ///< [sub-part][part element]: rho E_i
  std::vector<int> first_slab, last_slab;    ///< of each sub-part: those that can hold any of the part
  std::vector<int> of_layer;                 ///< sub-part of each layer
  std::vector<int> slab;                     ///< j of each layer, ascending within a sub-part

  int count() const { return static_cast<int>(density.size()); }
};

/// Densities of all stages and layers on the part elements. Layer j of the text is entry j - 1.
struct LayerDensities {
  std::vector<double> time_points;         ///< curved layers: T_0 = 0 ... T_N = 1; else empty
  std::vector<std::vector<double>> stage;  ///< [layer][part element]: what stands once the layer is built
  std::vector<std::vector<double>> layer;  ///< [layer][part element]: what the layer adds
  SubParts sub_parts;                      ///< multi-planar layers; else there are none

  int count() const { return static_cast<int>(layer.size()); }
  /// How far a pseudo-time lies before T_0 or after T_N of curved layers; 0 in between.
  double beyond(double time) const {
    return std::max({0.0, time - time_points.back(), time_points.front() - time});
  }
};

/// A response's derivative with respect to what LayerDensities holds; what nobody touched stays empty.
struct DensityDerivatives {
  std::vector<std::vector<double>> stage,
      layer;                        ///< like LayerDensities, or empty for a layer without derivative
  std::vector<double> time_points;  ///< explicit dependence on T_0 ... T_N; the same on all ranks
  std::vector<std::vector<double>> sub_part;  ///< by SubParts::density, or empty
  std::vector<double> directions;  ///< by SubParts::directions, this rank's part of the sum over all ranks

  explicit DensityDerivatives(int layers) : stage(layers), layer(layers) {}
  /// The entries of the time points, zeros at first use.
  std::vector<double>& time_points_or_zeros() { return zeros_if_empty(time_points, stage.size() + 1); }
  /// The entries of a sub-part's density, zeros at first use.
  std::vector<double>& sub_part_or_zeros(const SubParts& sub_parts, int number) {
    sub_part.resize(static_cast<std::size_t>(sub_parts.count()));
    return zeros_if_empty(sub_part[number], sub_parts.density[number].size());
  }
  /// The entries of the print directions, zeros at first use.
  std::vector<double>& directions_or_zeros(const SubParts& sub_parts) {
    return zeros_if_empty(directions, sub_parts.directions.size());
  }
  /// The entries of a layer, zeros at first use.
  static std::vector<double>& zeros_if_empty(std::vector<double>& entries, std::size_t elements) {
    if (entries.empty()) entries.assign(elements, 0.0);
    return entries;
  }
};

/// Layers of one design: of its pseudo-time and of its LayerVariables. Calls are collective on the grid's
/// communicator, and give the same bits on all copies of a rank (LayerGroups).
class Layers {
 public:
  virtual ~Layers() = default;

  /// Densities for a pseudo-time (part field), in the memory of an earlier result. Their number may differ
  /// from design to design.
  virtual void set_densities(std::span<const double> time, LayerDensities& densities) const = 0;
  /// Adds the derivative with respect to the pseudo-time to `d_time` (part field) and, unless that is empty,
  /// this rank's part of the one with respect to the layers' variables to `d_variables`: what its elements
  /// contribute, and all that is explicit in `derivatives`. Binary layers do not depend on the pseudo-time.
  /// \param densities  those of this pseudo-time
  virtual void pull_back(std::span<const double> time, const LayerDensities& densities,
                         const DensityDerivatives& derivatives, std::span<double> d_time,
                         std::span<double> d_variables) const = 0;
  /// Number of the layer (1 to N) that builds each part element, with sharp layers.
  virtual std::vector<double> layer_index(std::span<const double> time,
                                          const LayerDensities& densities) const = 0;
};

/// Layers in which no element's load factor, density^exponent, exceeds `load` divided by the number of slabs
/// may be left out.
struct NegligibleLayers {
  double load = 0.0;  ///< 0: only empty layers
  double exponent = 3.0;

  /// The largest density that is left out.
  double density(int slabs) const;
};

}  // namespace fabseq
