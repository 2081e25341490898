// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/parity.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/layers/layers.h"
#include "fabseq/process/built_region.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/strain_source.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// What the elements contribute to the systems of a block of steps, side by side, and to their derivatives
/// (docs/formulation.md 4.1, docs/developer/derivatives.md 8.2). `region`: the block and its elements; others
/// have no stiffness, load or derivatives.
template <int Dim>
class StepElements {
 public:
  /// The model must outlive the object.
  explicit StepElements(const ElasticModel<Dim>& model);

  /// Stiffness factor of each element of the model, [element][lane].
  std::vector<double> stiffness(const LayerDensities& densities, const BlockRegion& region) const;
  /// Sums of element values, [element of the model][lane], over the elements at each owned node. Collective.
  LaneVector at_nodes(std::span<const double> of_elements, int lanes) const;
  /// Sets `load` to f_s (BuildStep), one lane per step. Collective.
  void set_load(const LayerDensities& densities, const BlockRegion& region, const StrainSource<Dim>& strains,
                LaneVector& load) const;
  /// Adds dJ/drho_j,e = E' lambda^T K_0 du and dJ/d(drho_j,e) = -q drho^(q-1) lambda^T f_0 for the increments
  /// du of the block and its adjoints lambda, and, unless `d_inputs` is empty, what dJ/d(strain) amounts to
  /// with respect to the inputs of `strains`, this rank's part. Collective.
  void add_derivatives(const LayerDensities& densities, const BlockRegion& region,
                       const StrainSource<Dim>& strains, const LaneVector& increments,
                       const LaneVector& adjoints, DensityDerivatives& derivatives,
                       std::span<double> d_inputs) const;

 private:
  using ElementLoad = typename ElasticModel<Dim>::ElementLoad;
  /// Part elements begin ... end - 1 and the steps of a chunk of lanes.
  struct Chunk {
    std::size_t begin = 0, end = 0;
    int first_lane = 0;
    const BlockRegion& region;

    const BuildStep& step(int number) const { return region.steps[first_lane + number]; }
    StepBlock steps(int count) const { return {region.block.first + first_lane, count}; }
  };
  /// The strains of a block, and their load in a full element where they are the same everywhere.
  struct Strains {
    Strains(const ElasticModel<Dim>& model, const StrainSource<Dim>& source_);

    const StrainSource<Dim>& source;
    StrainVariation variation;
    ElementLoad common_load{};  ///< 0 where they vary
  };
  /// Elements taken at once: small enough for the cache to hold what a pass leaves to the next.
  static constexpr std::size_t chunk_size = 256;
  /// Elements whose strains are taken from the source at once.
  static constexpr std::size_t batch_size = 16;

  /// Calls `use.operator()<Width>(chunk, first lane)` for all elements and `lanes` lanes.
  template <class Use>
  void for_chunks(const BlockRegion& region, Use&& use) const;
  bool counts(const Chunk& chunk, std::size_t element) const {
    return chunk.region.has(static_cast<std::size_t>(model_.part_position[element]));
  }
  template <int Width>
  void add_load(const LayerDensities& densities, const Strains& strains, const Chunk& chunk, double* load,
                int lanes) const;
  template <int Width>
  void add_derivatives(const LayerDensities& densities, const Strains& strains, const Chunk& chunk,
                       const double* u, const double* lambda, int lanes, DensityDerivatives& derivatives,
                       std::span<double> d_inputs) const;
  /// Sets `work`, [element of the chunk][lane], to lambda^T f_0, and hands dJ/d(strain) to the source.
  template <int Width>
  void add_strain_derivatives(const LayerDensities& densities, const Strains& strains, const Chunk& chunk,
                              const double* lambda, int lanes, std::span<double> work,
                              std::span<double> d_inputs) const;
  /// Calls use(some of the elements, their strains, doubles from one element's to the next one's) for strains
  /// that vary, [Voigt][lane].
  template <int Width, class Use>
  static void for_batches(const Strains& strains, const Chunk& chunk, std::span<const int> elements,
                          Use&& use);
  /// Whether this rank has all nodes, so that owned and ghosted ones are the same.
  bool has_all_nodes() const {
    return model_.part.grid().owned_nodes().size == model_.part.grid().all_nodes().size;
  }
  /// Values on the ghosted nodes; `room` holds them if they are not the owned ones. Collective.
  const double* ghosted(const LaneVector& owned, std::vector<double>& room) const;

  const ElasticModel<Dim>& model_;
  ParityMatrix<Dim, Dim> stiffness_;
};

}  // namespace fabseq
