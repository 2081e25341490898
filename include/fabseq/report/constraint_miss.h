// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/optimize/best_iterate.h"
#include "fabseq/optimize/problem.h"
#include "fabseq/responses/response.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A constraint of the config, with what it allows. The same on all ranks.
struct ConstraintLimit {
  std::string type, unit;           ///< of the config; unit of its values, in words, may be empty
  std::string check;                ///< ResponseTraits::exact_check
  std::vector<ConstraintRow> rows;  ///< bounds of each of its values
};

/// All constraints, in the order of the config. Not collective.
template <int Dim>
std::vector<ConstraintLimit> constraint_limits(const Model<Dim>& model, const Problem<Dim>& problem);

/// The constraint that a design misses by most, in the unit of its own values. The same on all ranks.
struct ConstraintMiss {
  std::string name, type;           ///< of the component, such as constraint_0_3; of the config
  double value = 0.0, bound = 0.0;  ///< what it is, and the end of what is allowed
  bool is_share = false;            ///< both are shares
  double violation = 0.0;           ///< ConstraintRow::violation(), by which constraints are compared
  std::string words;                ///< "tilt is 27 % of the part, smoothly counted, allowed at most 0.1 %"
};

/// Checks the binary layers of a pipeline's last run, whatever layers it ran with; none without constraints
/// that have an exact check. `with_places`: BeyondLimits::places is looked for, else 0. Collective.
template <int Dim>
std::optional<BeyondLimits> beyond_limits(const Model<Dim>& model, const Problem<Dim>& problem,
                                          const Pipeline<Dim>& pipeline, const StageResults<Dim>& state,
                                          bool with_places);

/// None if all constraints hold; limits that adapt are left to the exact checks. `values`: of
/// Problem::responses(), [response][component]. Not collective.
template <int Dim>
std::optional<ConstraintMiss> worst_miss(const Model<Dim>& model, const Problem<Dim>& problem,
                                         const std::vector<std::vector<double>>& values);

}  // namespace fabseq
