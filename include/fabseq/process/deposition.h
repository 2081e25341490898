// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/element_halo.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/layers/layers.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"

#include <array>
#include <span>
#include <vector>

namespace fabseq {

/// How much of its increment a place keeps in each layer where material goes to nominal positions
/// (docs/formulation.md 4.6): a place moves with the part from the layer on that builds it,
///
///     w_j,n = 1 - prod_{e at n} (1 - rho_j,e / rho_e)
///
/// over the elements of part and substrate at node n; the substrate stands, and where there are none, w is 0.
/// Calls are collective on the grid's communicator. Source: fabseq's own.
template <int Dim>
class Deposition {
 public:
  /// The model must outlive the object. Collective.
  explicit Deposition(const ElasticModel<Dim>& model);

  /// w of a block of steps on some of this rank's nodes, one component: that of the layer that stands.
  LaneVector weights(const LayerDensities& densities, std::span<const BuildStep> steps,
                     std::span<const int> nodes) const;
  /// 1 - rho_j,e / rho_e of one layer, on this rank's elements and their neighbours (lexicographic), and 1
  /// behind them; 1 in the void, 0 in the substrate. Gathered once, it serves the derivatives of all
  /// functionals.
  using Missing = std::vector<double>;
  Missing missing(const std::vector<double>& stage) const;
  /// The same of the layers of some steps.
  std::vector<Missing> missing(const LayerDensities& densities, std::span<const BuildStep> steps) const;
  /// Adds dJ/drho_j,e of a functional with these dJ/dw, in the form of weights(). `missing`: that of
  /// the steps' layers.
  void add_derivatives(const std::vector<Missing>& missing, std::span<const BuildStep> steps,
                       std::span<const int> nodes, const LaneVector& d_weights,
                       DensityDerivatives& derivatives) const;

 private:
  /// Places in Missing of the elements at a node; outside its box, the one behind all.
  using Around = std::array<int, corner_count<Dim>>;

  void add_derivatives_at(const Around& around, const Missing& missing, double d_weight,
                          std::vector<double>& d_stage) const;

  const ElasticModel<Dim>& model_;
  ElementHalo<Dim> halo_;
  std::vector<Around> around_;     ///< of Grid::ghosted_nodes()
  std::vector<int> ghosted_;       ///< Grid::owned_nodes() in Grid::ghosted_nodes()
  std::vector<int> part_element_;  ///< this rank's part element at each place in Missing, or -1
};

}  // namespace fabseq
