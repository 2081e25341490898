// SPDX-License-Identifier: MIT
#include "fabseq/run/deposition_report.h"

#include "fabseq/process/counted_as.h"
#include "fabseq/responses/response_type.h"

namespace fabseq {

namespace {

/// By the model that the state now counts by.
template <int Dim>
DepositionNumbers deposition_numbers(const Model<Dim>& model, const Problem<Dim>& problem,
                                     Pipeline<Dim>& pipeline, const PipelineState<Dim>& state) {
  const std::vector<double>& displacement = state.process.displacement;
  DepositionNumbers result;
  result.part = displacement_size(model.part, displacement);
  if (const auto nodes = measured_nodes(model))
    result.nodes = displacement_size(model.part, displacement, nodes);
  const auto terms = problem.responses().first(problem.objective_count());
  for (NamedValue& term : problem.describe(pipeline.values(terms, state)))
    if (term.type == "distortion") result.distortions.push_back(std::move(term));
  return result;
}

}  // namespace

template <int Dim>
BothDepositions report_depositions(const Model<Dim>& model, const Problem<Dim>& problem,
                                   Pipeline<Dim>& pipeline, const PipelineState<Dim>& state) {
  const bool is_nominal = model.settings.process.deposition == DepositionModel::nominal;
  const DepositionModel other = is_nominal ? DepositionModel::follow : DepositionModel::nominal;
  BothDepositions result;
  (is_nominal ? result.nominal : result.follow) = deposition_numbers(model, problem, pipeline, state);
  const CountedAs<Dim> counted(other, pipeline.process().model(), model.groups, state.layers,
                               pipeline.process().result());
  (is_nominal ? result.follow : result.nominal) = deposition_numbers(model, problem, pipeline, state);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(report_depositions);

}  // namespace fabseq
