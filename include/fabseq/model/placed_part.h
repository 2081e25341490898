// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layer_model.h"
#include "fabseq/model/group_choice.h"
#include "fabseq/model/model_settings.h"
#include "fabseq/model/run_size.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/part/node_set.h"
#include "fabseq/part/part.h"
#include "fabseq/responses/response.h"
#include "fabseq/sequence/sequence_kind.h"

#include <map>
#include <memory>
#include <string>

namespace fabseq {

/// The groups of a run, the part as the ranks of each of them have it, and what its size follows from. Its
/// members refer to each other.
template <int Dim>
struct PlacedPart {
  /// `description`: the settings' part, maybe without its warnings. Collective on `world`; both must outlive
  /// the object. Throws InputError for anything wrong with part, node sets, start region, layers or terms.
  PlacedPart(MPI_Comm world, const ModelSettings& settings_, const GroupChoice& choice_,
             const PartDescription& description);
  PlacedPart(PlacedPart&&) = delete;

  const ModelSettings& settings;
  GroupChoice choice;
  LayerGroups groups;
  Grid<Dim> grid;
  Part<Dim> part;
  SequencePlaces<Dim> places;
  std::map<std::string, NodeSet> node_sets;
  std::unique_ptr<const LayerModel<Dim>> layers;  ///< of the design
  SequenceSettings sequence;                 ///< the settings', with the lengths that follow from the part
  double characteristic_length;              ///< l_c, length unit
  ResponseList<Dim> objective, constraints;  ///< their terms
  RunSize size;

  ResponseContext<Dim> context() const;
};

/// The part in as many groups as `solver.layer_groups` says, or in the number of groups that is the fastest
/// by a model of the time and fits the memory now available. Collective; throws as the constructor, and if
/// ranks cannot be dealt out so.
template <int Dim>
std::unique_ptr<PlacedPart<Dim>> place_part(MPI_Comm world, const ModelSettings& settings);

}  // namespace fabseq
