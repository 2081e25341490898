// SPDX-License-Identifier: MIT
#include "fabseq/process/counted_as.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/run/sequence_report.h"

namespace fabseq {

namespace {

/// By the model that the state now counts by.
template <int Dim>
DepositionNumbers deposition_numbers(const Model<Dim>& model, const Problem<Dim>& problem,
                                     Pipeline<Dim>& pipeline, const PipelineState<Dim>& state) {
  DepositionNumbers result{displacement_sizes(model, state.process.displacement), {}};
  const auto terms = problem.responses().first(problem.objective_count());
  for (NamedValue& term : problem.describe(pipeline.values(terms, state)))
    if (term.type == "distortion") result.distortions.push_back(std::move(term));
  return result;
}

}  // namespace

template <int Dim>
BothDepositions report_depositions(const Model<Dim>& model, const Problem<Dim>& problem,
                                   Pipeline<Dim>& pipeline, const PipelineState<Dim>& state) {
  const DepositionModel own_model = model.settings.process.deposition;
  const bool is_nominal = own_model == DepositionModel::nominal;
  const DepositionModel other_model = is_nominal ? DepositionModel::follow : DepositionModel::nominal;
  DepositionNumbers own = deposition_numbers(model, problem, pipeline, state);
  const CountedAs<Dim> counted(other_model, pipeline.process().model(), model.groups, state.layers,
                               pipeline.process().result());
  return {std::move(own), deposition_numbers(model, problem, pipeline, state), own_model};
}

FABSEQ_INSTANTIATE_FUNCTION(report_depositions);

}  // namespace fabseq
