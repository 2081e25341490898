// SPDX-License-Identifier: MIT
#include "fabseq/model/placed_part.h"

#include "fabseq/base/machine_cores.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/responses/response_type.h"

#include <optional>
#include <span>

namespace fabseq {

namespace {

template <int Dim>
ResponseList<Dim> make_responses(const std::vector<Term>& terms, const ResponseContext<Dim>& context) {
  ResponseList<Dim> result;
  for (const Term& term : terms) result.push_back(term.type->make(term, context));
  return result;
}

template <int Dim>
SequenceSettings with_lengths(const ModelSettings& settings, const Part<Dim>& part, int layers) {
  SequenceSettings result = settings.sequence;
  result.kind->fix_lengths(result, part, settings.layers.height_of(layers));
  return result;
}

}  // namespace

template <int Dim>
PlacedPart<Dim>::PlacedPart(MPI_Comm world, const ModelSettings& settings_, const GroupChoice& choice_,
                            const PartDescription& description)
    : settings(settings_),
      choice(choice_),
      groups(world, choice.groups),
      grid(make_balanced_grid(groups.domain(), settings.domain<Dim>(), description)),
      part(grid, description, settings.plate),
      places(settings.sequence.kind->places(settings.sequence, part)),
      node_sets(make_node_sets(part, settings.node_sets)),
      layers(make_layer_model(settings.layers, settings.projection, part)),
      sequence(with_lengths(settings, part, layers->count())),
      characteristic_length(sequence.facts.characteristic_length.value_or(part.longest_edge())),
      objective(make_responses(settings.objective, context())),
      constraints(make_responses(settings.constraints, context())),
      size(run_size(settings, part, objective, layers->count(), size_of(world))) {}

template <int Dim>
ResponseContext<Dim> PlacedPart<Dim>::context() const {
  return {part,
          node_sets,
          characteristic_length,
          places.start ? std::span<const char>(places.start->elements) : std::span<const char>{},
          layers->traits().sub_parts,
          settings.tool,
          settings.layers.target ? settings.layers.target->value : 0.0,
          settings.thermal,
          settings.clock(),
          settings.layers.passes};
}

template <int Dim>
std::unique_ptr<PlacedPart<Dim>> place_part(MPI_Comm world, const ModelSettings& settings) {
  const int ranks = size_of(world);
  const NodeCores cores = fewest_cores(world);
  const auto placed = [&](const GroupChoice& choice, const PartDescription& description) {
    auto result = std::make_unique<PlacedPart<Dim>>(world, settings, choice, description);
    result->size.cores_per_rank = cores.per_rank();
    return result;
  };
  const std::optional<int>& asked = settings.solver.layer_groups;
  if (asked || ranks == 1) return placed(asked_choice(asked.value_or(1), ranks), settings.part);
  // Number of layers and size of the systems are known once there is a part: as a rule, this one will do.
  const auto available = static_cast<double>(available_memory_bytes(world));
  auto result = placed(likely_choice<Dim>(settings, ranks, cores.per_rank(), available), settings.part);
  const GroupChoice choice = fastest_choice<Dim>(settings, result->size, available);
  if (choice.groups == result->choice.groups) {
    result->choice = choice;
    return result;
  }
  result.reset();
  PartDescription quiet = settings.part;
  quiet.announce = false;
  return placed(choice, quiet);
}

FABSEQ_INSTANTIATE_STRUCT(PlacedPart);
FABSEQ_INSTANTIATE_FUNCTION(place_part);

}  // namespace fabseq
