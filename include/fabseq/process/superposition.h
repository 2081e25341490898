// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// What holds for a process that is linear in its strain, and for no other: results of a combination of
/// strain cases are that combination of the cases' results, and so are derivatives (docs/formulation.md 4.7,
/// 12). Scenarios, noise, and one adjoint for several functionals ask for it (ProcessResult::superposition).
/// Local.
class Superposition {
 public:
  /// \param cases      number of strain cases that are simulated
  /// \param scenarios  each as a combination of them, [scenario][case]
  Superposition(std::size_t cases, std::vector<std::vector<double>> scenarios)
      : cases_(cases), scenarios_(std::move(scenarios)) {}

  std::size_t case_count() const { return cases_; }
  const std::vector<std::vector<double>>& scenarios() const { return scenarios_; }
  /// The result for a combination of the cases, which has no other cases; increments, which take memory, only
  /// if asked for.
  ProcessResult combined(const ProcessResult& result, std::span<const double> combination,
                         bool with_increments) const;
  /// Increments of a block for a combination of the cases.
  LaneVector increments(const ProcessResult& result, std::span<const double> combination,
                        std::size_t block) const;
  /// The result of a part of the strain that leads to this displacement: it has no increments, other cases or
  /// release.
  ProcessResult of_part(const ProcessResult& result, std::vector<double> displacement) const;
  /// The same sum of functionals with one of them for each case, if that makes them fewer: each costs an
  /// adjoint solve. Ranks with the same numbers of functionals get the same number.
  std::vector<ProcessAdjoint> reduced(std::vector<ProcessAdjoint> functionals) const;

 private:
  std::size_t cases_;
  std::vector<std::vector<double>> scenarios_;
};

}  // namespace fabseq
