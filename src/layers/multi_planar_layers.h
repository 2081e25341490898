// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layer_settings.h"
#include "fabseq/layers/layers.h"
#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// Sub-parts of planar layers, each with a print direction n_i of its own (docs/formulation.md 3.2): layer
/// (i, j) is slab j, of equal thickness across n_i, of sub-part i,
///
///     drho = rho E_i E_ij,   rho_stage = rho (H(t; tau_{i-1}) + E_i sum_{k <= j} E_ik),
///
/// sub-part by sub-part and slab by slab. Slabs of which the part has next to nothing are no layers. The
/// variables are the angles of the n_i, [sub-part][angle].
template <int Dim>
class MultiPlanarLayers : public Layers {
 public:
  /// `binary`: sharp steps. Part and settings must outlive the object.
  MultiPlanarLayers(const Part<Dim>& part, const MultiPlanarSettings& settings,
                    std::span<const double> angles, bool binary, const NegligibleLayers& negligible);

  void set_densities(std::span<const double> time, LayerDensities& densities) const override;
  void pull_back(std::span<const double> time, const LayerDensities& densities,
                 const DensityDerivatives& derivatives, std::span<double> d_time,
                 std::span<double> d_variables) const override;
  std::vector<double> layer_index(std::span<const double> time,
                                  const LayerDensities& densities) const override;

 private:
  /// Derivatives with respect to the fields that a sub-part's layers are made of, part fields.
  struct FieldDerivatives {
    std::vector<double> before;    ///< by H(t; tau_{i-1})
    std::vector<double> sub_part;  ///< by E_i
    std::vector<double> height;    ///< by S_i
  };

  /// H(t; tau_i) = 1 - logistic(k1 (t - tau_i)) of the part elements, 1 before a timestamp and 0 after it; i
  /// from 0 to the number of sub-parts.
  std::vector<double> built_until(std::span<const double> time, int boundary) const;
  /// Adds factor * dH(t; tau_i)/dt * weight.
  void add_step_derivative(std::span<const double> time, int boundary, double factor,
                           std::span<const double> weight, std::span<double> d_time) const;
  /// S_i of the part elements.
  std::vector<double> heights(int sub_part) const;
  /// E_ij for heights.
  void set_slab(std::span<const double> height, int slab, std::span<double> values) const;
  int sharp_slab(double height) const;
  void find_slabs(const std::vector<std::vector<double>>& height, SubParts& sub_parts) const;
  std::vector<std::vector<double>> largest_densities(const std::vector<std::vector<double>>& height,
                                                     const SubParts& sub_parts) const;
  FieldDerivatives derivatives_of_fields(std::span<const double> height, int sub_part,
                                         const LayerDensities& densities,
                                         const DensityDerivatives& derivatives) const;

  const Part<Dim>& part_;
  const MultiPlanarSettings& settings_;
  std::vector<double> angles_, directions_;
  bool binary_;
  NegligibleLayers negligible_;
  std::vector<double> centers_;  ///< of the part elements, from the lower corner, [part element][axis]
};

}  // namespace fabseq
