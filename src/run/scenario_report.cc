// SPDX-License-Identifier: MIT
#include "fabseq/responses/response_type.h"
#include "fabseq/run/sequence_report.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

/// The same term with another aggregate.
Term with_aggregate(Term term, const char* aggregate) {
  term.keys["aggregate"] = aggregate;
  return term;
}

}  // namespace

template <int Dim>
std::vector<ScenarioNumbers> report_scenarios(const Model<Dim>& model, const Problem<Dim>& problem,
                                              Pipeline<Dim>& pipeline, const PipelineState<Dim>& state) {
  std::vector<ScenarioNumbers> result;
  if (model.settings.material.scenarios.empty()) return result;
  for (std::size_t i = 0; i < model.settings.objective.size(); ++i) {
    const Term& term = model.settings.objective[i];
    if (find_member(term.keys, "aggregate") == nullptr) continue;
    std::vector<std::unique_ptr<Response<Dim>>> responses;
    responses.push_back(term.type->make(with_aggregate(term, "worst"), model.context())->largest_of());
    responses.push_back(term.type->make(with_aggregate(term, "spread"), model.context()));
    auto values = pipeline.values(responses, state);
    ScenarioNumbers numbers{problem.component_name(i, 0), std::move(values[0])};
    const auto& all = numbers.values;
    numbers.mean = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
    numbers.spread = values[1][0];
    numbers.worst = *std::max_element(all.begin(), all.end());
    result.push_back(std::move(numbers));
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(report_scenarios);

}  // namespace fabseq
