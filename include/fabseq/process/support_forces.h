// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/layers/layers.h"
#include "fabseq/process/built_region.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/strain_source.h"

#include <span>
#include <vector>

namespace fabseq {

/// What the supports do to the systems of the steps: reactions, and supports that move (docs/formulation.md
/// 4.3). `region`: the steps in the lanes, and the elements that their systems have. Calls are collective on
/// the grid's communicator.
template <int Dim>
class SupportForces {
 public:
  /// Collective. The model must outlive the object.
  explicit SupportForces(const ElasticModel<Dim>& model);

  /// Adds sum_j (K_j du_j - f_j) on the supports to `reactions`, [owned node][component].
  void add_reactions(const LayerDensities& densities, const StrainSource<Dim>& strains,
                     const BlockRegion& region, const LaneVector& increments,
                     std::span<double> reactions) const;
  /// Takes K_j w from the loads of the steps, w ([owned node][component]) counting on the supports only:
  /// loads of a system whose supports are moved by w.
  void subtract_motion(const LayerDensities& densities, const BlockRegion& region,
                       std::span<const double> motion, LaneVector& loads) const;
  /// Adds w to lanes of solutions, on the supports.
  void add_motion(std::span<const double> motion, LaneVector& solutions) const;

 private:
  /// Offset in the ghosted box of the node of an unknown of an element.
  std::size_t node(std::size_t element, int unknown) const {
    return model_.domain.first_corners[element] + model_.part.grid().corner_offsets()[unknown / Dim];
  }

  using ElementLoad = typename ElasticModel<Dim>::ElementLoad;
  /// f_j of the elements at supports, summed over the steps of a region, in the order of `elements_`.
  std::vector<ElementLoad> summed_loads(const LayerDensities& densities, const StrainSource<Dim>& strains,
                                        const BlockRegion& region) const;

  const ElasticModel<Dim>& model_;
  std::vector<int> elements_;  ///< of the model, that have a fixed node
};

}  // namespace fabseq
