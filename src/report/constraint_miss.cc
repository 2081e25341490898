// SPDX-License-Identifier: MIT
#include "fabseq/report/constraint_miss.h"

#include "fabseq/base/formatted.h"
#include "fabseq/report/verdict.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>

namespace fabseq {

namespace {

std::string words_of(const ConstraintMiss& miss, const std::string& unit, const std::string& place,
                     bool above) {
  const auto number = [&](double value) {
    return miss.is_share ? percent_words(value) : formatted("%.4g", value);
  };
  std::string type = miss.type;
  std::replace(type.begin(), type.end(), '_', ' ');
  return type + place + " is " + number(miss.value) +
         (miss.is_share  ? " of the part, smoothly counted"
          : unit.empty() ? ""
                         : " " + unit) +
         ", allowed at " + (above ? "most " : "least ") + number(miss.bound);
}

}  // namespace

template <int Dim>
std::vector<ConstraintLimit> constraint_limits(const Model<Dim>& model, const Problem<Dim>& problem) {
  std::vector<ConstraintLimit> limits;
  for (const Term& term : model.settings.constraints)
    limits.push_back({term.type->name, term.type->unit, term.type->exact_check,
                      problem.responses()[problem.objective_count() + limits.size()]->rows(1.0)});
  return limits;
}

template <int Dim>
std::optional<ConstraintMiss> worst_miss(const Model<Dim>& model, const Problem<Dim>& problem,
                                         const std::vector<std::vector<double>>& values) {
  std::optional<ConstraintMiss> worst;
  std::size_t r = problem.objective_count();
  for (const auto& [type, unit, check, rows] : constraint_limits(model, problem)) {
    for (const ConstraintRow& row : rows)
      for (std::size_t c = 0; c < values[r].size(); ++c) {
        const double violation = row.violation(values[r][c]);
        if (row.adapts || violation <= (worst ? worst->violation : 0.0)) continue;
        worst = {problem.component_name(r, c),
                 type,
                 values[r][c],
                 row.bound,
                 unit == share_of_part,
                 violation,
                 ""};
        const std::string place = values[r].size() > 1 ? ", component " + std::to_string(c) + "," : "";
        worst->words = words_of(*worst, unit, place, row.sign > 0.0);
      }
    ++r;
  }
  return worst;
}

template <int Dim>
std::optional<BeyondLimits> beyond_limits(const Model<Dim>& model, const Problem<Dim>& problem,
                                          const Pipeline<Dim>& pipeline, const StageResults<Dim>& state,
                                          bool with_places) {
  const auto limits = constraint_limits(model, problem);
  if (std::all_of(limits.begin(), limits.end(), [](const auto& limit) { return limit.check.empty(); }))
    return std::nullopt;
  const BuildReport report =
      with_places ? check_places(model, pipeline, state) : check_build(model, pipeline, state);
  const Verdict verdict = judge(report.numbers, model.settings);
  BeyondLimits beyond;
  beyond.places = verdict.places;
  beyond.shares.assign(limits.size(), 0.0);
  for (const BrokenLimit& broken : verdict.broken) {
    bool is_limited = false;
    for (std::size_t i = 0; i < limits.size(); ++i) {
      if (limits[i].check != broken.name) continue;
      beyond.shares[i] = broken.share;
      is_limited = true;
    }
    if (is_limited) beyond.share += broken.share;
  }
  return beyond;
}

FABSEQ_INSTANTIATE_FUNCTION(beyond_limits);
FABSEQ_INSTANTIATE_FUNCTION(constraint_limits);
FABSEQ_INSTANTIATE_FUNCTION(worst_miss);

}  // namespace fabseq
