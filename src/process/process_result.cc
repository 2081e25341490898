// SPDX-License-Identifier: MIT
#include "fabseq/process/process_result.h"

#include <utility>

namespace fabseq {

void add_scaled(std::vector<double>& to, double factor, const std::vector<double>& from) {
  to.resize(from.size(), 0.0);
  for (std::size_t i = 0; i < from.size(); ++i) to[i] += factor * from[i];
}

void ProcessResult::add_counted(std::size_t block, CaseDisplacements& of) const {
  const LaneVector& own = of.increments[block];
  for (std::size_t i = 0; i < own.unknowns(); ++i) {
    const double* share = weights.empty() ? nullptr : &weights[block].values[i / own.components * own.lanes];
    for (int lane = 0; lane < own.lanes; ++lane)
      of.displacement[in_field(block, i, own.components)] +=
          (share != nullptr ? share[lane] : 1.0) * own(i, lane);
  }
}

ProcessResult ProcessResult::combined(std::span<const double> combination, bool with_increments) const {
  ProcessResult result = at_once({});
  for (std::size_t k = 0; k < combination.size(); ++k) {
    add_scaled(result.displacement, combination[k], of_case(k).displacement);
    add_scaled(result.release, combination[k], of_case(k).release);
  }
  if (!with_increments) return result;
  result.blocks = blocks;
  result.nodes = nodes;
  result.weights = weights;
  for (std::size_t block = 0; block < blocks.size(); ++block)
    result.increments.push_back(combined_increments(combination, block));
  return result;
}

ProcessResult ProcessResult::at_once(std::vector<double> displacement) const {
  ProcessResult result;
  result.all_layers = all_layers;
  result.iterations = iterations;
  result.displacement = std::move(displacement);
  return result;
}

LaneVector ProcessResult::combined_increments(std::span<const double> combination, std::size_t block) const {
  LaneVector result(increments[block].nodes, increments[block].components, increments[block].lanes);
  for (std::size_t k = 0; k < combination.size(); ++k)
    if (combination[k] != 0.0) add_scaled(result.values, combination[k], of_case(k).increments[block].values);
  return result;
}

}  // namespace fabseq
