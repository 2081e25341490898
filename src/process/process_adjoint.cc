// SPDX-License-Identifier: MIT
#include "fabseq/process/process_adjoint.h"

namespace fabseq {

namespace {

void add(ProcessAdjoint& to, double factor, const ProcessAdjoint& from) {
  if (!from.displacement.empty()) add_scaled(to.displacement, factor, from.displacement);
  if (!from.release.empty()) add_scaled(to.release, factor, from.release);
  for (std::size_t block = 0; block < from.increments.size(); ++block) {
    const LaneVector& own = from.increments[block];
    if (to.increments.size() <= block) to.increments.emplace_back(own.nodes, own.components, own.lanes);
    add_scaled(to.increments[block].values, factor, own.values);
  }
}

double factor_of(const ProcessAdjoint& functional, std::size_t number) {
  if (functional.combination.empty()) return number == 0 ? 1.0 : 0.0;
  return functional.combination[number];
}

}  // namespace

std::vector<ProcessAdjoint> reduced(std::vector<ProcessAdjoint> functionals, std::size_t cases) {
  if (functionals.size() <= cases) return functionals;
  std::vector<ProcessAdjoint> result(cases);
  for (std::size_t number = 0; number < cases; ++number) {
    result[number].combination.assign(cases, 0.0);
    result[number].combination[number] = 1.0;
    for (const ProcessAdjoint& functional : functionals) {
      const double factor = factor_of(functional, number);
      if (factor != 0.0) add(result[number], factor, functional);
    }
  }
  return result;
}

LaneVector weight_derivatives(const ProcessAdjoint& functional, const ProcessResult& result,
                              std::size_t block, const LaneVector& increments) {
  LaneVector weights(increments.nodes, 1, increments.lanes);
  for (std::size_t i = 0; i < increments.unknowns(); ++i) {
    const double common = functional.displacement.empty()
                              ? 0.0
                              : functional.displacement[result.in_field(block, i, increments.components)];
    for (int lane = 0; lane < increments.lanes; ++lane) {
      const double own = functional.increments.empty() ? 0.0 : functional.increments[block](i, lane);
      weights(i / increments.components, lane) += (common + own) * increments(i, lane);
    }
  }
  return weights;
}

}  // namespace fabseq
