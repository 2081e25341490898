// SPDX-License-Identifier: MIT
#include "fabseq/process/superposition.h"

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

ProcessResult Superposition::combined(const ProcessResult& result, std::span<const double> combination,
                                      bool with_increments) const {
  ProcessResult sum = of_part(result, {});
  for (std::size_t k = 0; k < combination.size(); ++k) {
    add_scaled(sum.displacement, combination[k], result.of_case(k).displacement);
    add_scaled(sum.release, combination[k], result.of_case(k).release);
  }
  if (!with_increments) return sum;
  sum.steps = result.steps;
  sum.blocks = result.blocks;
  sum.nodes = result.nodes;
  sum.weights = result.weights;
  for (std::size_t block = 0; block < result.blocks.size(); ++block)
    sum.increments.push_back(increments(result, combination, block));
  return sum;
}

LaneVector Superposition::increments(const ProcessResult& result, std::span<const double> combination,
                                     std::size_t block) const {
  const LaneVector& first = result.increments[block];
  LaneVector sum(first.nodes, first.components, first.lanes);
  for (std::size_t k = 0; k < combination.size(); ++k)
    if (combination[k] != 0.0)
      add_scaled(sum.values, combination[k], result.of_case(k).increments[block].values);
  return sum;
}

ProcessResult Superposition::of_part(const ProcessResult& result, std::vector<double> displacement) const {
  ProcessResult part;
  part.all_layers = result.all_layers;
  part.iterations = result.iterations;
  part.superposition = result.superposition;
  part.displacement = std::move(displacement);
  return part;
}

std::vector<ProcessAdjoint> Superposition::reduced(std::vector<ProcessAdjoint> functionals) const {
  if (functionals.size() <= cases_) return functionals;
  std::vector<ProcessAdjoint> result(cases_);
  for (std::size_t number = 0; number < cases_; ++number) {
    result[number].combination.assign(cases_, 0.0);
    result[number].combination[number] = 1.0;
    for (const ProcessAdjoint& functional : functionals) {
      const double factor = factor_of(functional, number);
      if (factor != 0.0) add(result[number], factor, functional);
    }
  }
  return result;
}

}  // namespace fabseq
