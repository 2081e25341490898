// SPDX-License-Identifier: MIT
#include "tasks/repaired_sequence.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/session.h"
#include "fabseq/repair/layer_repair.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/given_sequence.h"

#include <utility>

namespace fabseq {

namespace {

RepairReport report_of(const SequenceNumbers& before, const LayerChanges& changes,
                       const ModelSettings& settings) {
  const bool released = any_measures_release(settings.objective) && before.finished->released;
  const DisplacementSize& skin = before.finished->deviation(released).skin;
  return {changes, before.verdict->build_class, before.verdict->places, skin.rms, skin.largest};
}

}  // namespace

template <int Dim>
std::optional<RepairedSequence<Dim>> repair_sequence(const Setup<Dim>& setup, const Problem<Dim>& problem,
                                                     Pipeline<Dim>& pipeline, const Design& design,
                                                     double beta, const SequenceNumbers& before,
                                                     PhaseTimer& timer) {
  if (before.verdict->buildable()) return std::nullopt;
  auto repaired = repair_layers(setup, *pipeline.last_time(), design.layer_variables,
                                setup.config.optimizer.repair_share);
  if (!repaired) return std::nullopt;
  pipeline.release_memory();
  Design layers_alone;
  layers_alone.layer_variables = design.layer_variables;
  auto mended =
      std::make_unique<Pipeline<Dim>>(setup, std::make_unique<GivenSequence<Dim>>(std::move(repaired->time)),
                                      *setup.layers, setup.config.solver.finest_tolerance(), timer);
  mended->set_tolerances(pipeline.tolerances());
  const auto state = mended->run(layers_alone, beta, true);
  SequenceReport binary = report_sequence(setup, problem, *mended, state);
  RepairedSequence<Dim> result{std::move(mended), state, std::move(layers_alone), std::move(binary),
                               report_of(before, repaired->changes, setup.settings)};
  print(formatted("repair: %lld elements, %zu of them to another layer: %lld places left of %lld",
                  static_cast<long long>(result.repair.changes.repaired), result.repair.changes.moved.size(),
                  static_cast<long long>(result.binary.verdict->places),
                  static_cast<long long>(result.repair.places)));
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(repair_sequence);

}  // namespace fabseq
