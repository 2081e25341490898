// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/parity.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/layers/layers.h"
#include "fabseq/process/built_region.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/strain_cases.h"

#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// What the elements contribute to the systems of a block of layers, side by side, and to their derivatives
/// (docs/formulation.md 4.1, 8). `region`: the block and its elements; others have no stiffness, load or
/// derivatives. `factors`: on the inherent strain.
template <int Dim>
class LayerElements {
 public:
  /// The model must outlive the object.
  explicit LayerElements(const ElasticModel<Dim>& model);

  /// Inherent strains from now on.
  void set_strains(StrainField strains) { strains_ = std::move(strains); }
  const StrainField& strains() const { return strains_; }

  /// Stiffness factor of each element of the model, [element][lane].
  std::vector<double> stiffness(const LayerDensities& densities, const BlockRegion& region) const;
  /// Sets `load` to f_j, one lane per layer. Collective.
  void set_load(const LayerDensities& densities, const BlockRegion& region, const StrainFactors<Dim>& factors,
                LaneVector& load) const;
  /// Adds dJ/drho_j,e = E' lambda^T K_0 du and dJ/d(drho_j,e) = -q drho^(q-1) lambda^T f_0 for the increments
  /// du of the block and its adjoints lambda. With strains of the elements' or the layers' own also
  /// dJ/d(strain), this rank's part, to `d_strains`, unless that is uniform. Collective.
  void add_derivatives(const LayerDensities& densities, const BlockRegion& region,
                       const StrainFactors<Dim>& factors, const LaneVector& increments,
                       const LaneVector& adjoints, DensityDerivatives& derivatives,
                       StrainField& d_strains) const;

 private:
  /// Part elements begin ... end - 1, the layers of a chunk of lanes, and factors on their strain.
  struct Chunk {
    std::size_t begin = 0, end = 0;
    int first_layer = 0;
    const BlockRegion& region;
    const StrainFactors<Dim>& factors;
  };
  /// Elements taken at once: small enough for the cache to hold what a pass leaves to the next.
  static constexpr std::size_t chunk_size = 256;

  /// Calls `use.operator()<Width>(chunk, first lane)` for all elements and `lanes` lanes.
  template <class Use>
  void for_chunks(const BlockRegion& region, const StrainFactors<Dim>& factors, Use&& use) const;
  bool counts(const Chunk& chunk, std::size_t element) const {
    return chunk.region.has(static_cast<std::size_t>(model_.part_position[element]));
  }
  template <int Width>
  void add_load(const LayerDensities& densities, const Chunk& chunk, double* load, int lanes) const;
  template <int Width>
  void add_derivatives(const LayerDensities& densities, const Chunk& chunk, const double* u,
                       const double* lambda, int lanes, DensityDerivatives& derivatives,
                       StrainField& d_strains) const;
  /// A component of the strain of an element in the layers of a chunk, as Lanes<Width>.
  template <class Result>
  Result strain(const Chunk& chunk, std::size_t element, int component) const;
  /// lambda^T f_0 where strains are not the material's to `work`, [element][lane of the chunk], and their
  /// dJ/d(strain).
  template <int Width>
  void add_strain_derivatives(const LayerDensities& densities, const Chunk& chunk, const double* lambda,
                              int lanes, std::span<double> work, StrainField& d_strains) const;
  /// Whether this rank has all nodes, so that owned and ghosted ones are the same.
  bool has_all_nodes() const {
    return model_.part.grid().owned_nodes().size == model_.part.grid().all_nodes().size;
  }
  /// Values on the ghosted nodes; `room` holds them if they are not the owned ones. Collective.
  const double* ghosted(const LaneVector& owned, std::vector<double>& room) const;

  const ElasticModel<Dim>& model_;
  ParityMatrix<Dim, Dim> stiffness_;
  StrainField strains_;
};

}  // namespace fabseq
