// SPDX-License-Identifier: MIT
/// \file
/// From a config to the things that do not change during a run: grid, part, node sets, counts.
#pragma once

#include "fabseq/config/config.h"
#include "fabseq/files/design_layout.h"
#include "fabseq/layers/layer_variables.h"
#include "fabseq/optimize/run_cost.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/part/node_set.h"
#include "fabseq/part/part.h"
#include "fabseq/part/supports.h"
#include "fabseq/responses/response.h"
#include "fabseq/sequence/design_support.h"
#include "fabseq/sequence/start_region.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Layer groups, grid, part, places of the design variables and node sets of a config, with what "auto"
/// stands for. Collective construction on the world of the run; every layer group has the same grid, part and
/// node sets on its ranks. Cannot be copied or moved, since its members refer to each other. Throws
/// InputError for anything wrong with part, plate, substrate, clamps, start region or node sets, and for a
/// release that there cannot be.
template <int Dim>
class Setup {
 public:
  Setup(MPI_Comm world, const Config& config_);
  Setup(const Setup&) = delete;
  Setup& operator=(const Setup&) = delete;

  const Config& config;
  const GroupChoice group_choice;
  const LayerGroups groups;
  Grid<Dim> grid;
  Part<Dim> part;
  Supports<Dim> supports;
  std::optional<StartRegion> start;   ///< of a direct sequence
  DesignSupport<Dim> design_support;  ///< where the sequence has variables
  std::map<std::string, NodeSet> node_sets;
  int layer_count;  ///< N, "auto" resolved; of multi-planar layers an estimate
  LayerVariables layer_variables;
  int baseline_layers;           ///< of the planar baseline
  int lanes;                     ///< layers solved side by side at most, "auto" resolved
  double characteristic_length;  ///< l_c, length unit

  /// All ranks of the run; the grid has a communicator of its own.
  MPI_Comm world() const { return groups.world(); }
  BlockSolver block_solver() const { return fabseq::block_solver(config.solver.path); }
  /// A design's field, or anything else of which this rank has its share, on the owned elements or nodes.
  /// Collective.
  std::vector<double> design_field(std::span<const double> share) const {
    return design_support.expand(groups.gather(share));
  }
  /// The same, and back, for files.
  DesignLayout<Dim> design_layout() const;
  /// 1 on the owned elements of the substrate, as a field for files.
  std::vector<double> substrate_field() const {
    return {part.substrate().elements().begin(), part.substrate().elements().end()};
  }
  ResponseContext<Dim> context() const {
    return {part, node_sets, characteristic_length,
            start ? std::span<const char>(start->elements) : std::span<const char>{},
            config.layers.multi_planar ? config.layers.multi_planar->subparts : 0};
  }
  /// Sharpness at the start and at the end of the continuation, "auto" resolved; that of multi-planar layers
  /// stays.
  double first_beta() const {
    return config.layers.multi_planar ? config.layers.multi_planar->time_sharpness
                                      : config.projection.beta.value_or(4.0 * layer_count);
  }
  double last_beta() const {
    return config.layers.multi_planar ? first_beta() : config.projection.max.value_or(13.5 * layer_count);
  }
  /// Whether layers are steps, not smooth: where that is asked for, and planar ones.
  bool binary() const { return config.projection.binary || config.sequence.type == SequenceType::planar; }
  /// Throws InputError if the densities and displacements of all layers are more than the machines of this
  /// run can hold. Collective.
  void require_memory_of_layers() const;

 private:
  void warn_about_method() const;
  void require_release() const;
  int resolve_baseline_layers() const;
};

extern template class Setup<2>;
extern template class Setup<3>;

}  // namespace fabseq
