// SPDX-License-Identifier: MIT
#include "process/plastic_adjoint.h"

#include "fabseq/process/adjoint_loads.h"

#include <algorithm>
#include <array>

namespace fabseq {

namespace {

constexpr std::size_t step_size = static_cast<std::size_t>(ElementModes::components) * plastic_width;

}  // namespace

std::vector<int> PlasticAdjoint::run(std::span<const ProcessAdjoint> functionals,
                                     std::span<const ProcessDerivatives> derivatives, double change,
                                     std::span<std::vector<LaneVector>> unknowns) {
  const std::vector<PlasticWave>& waves = forward_.waves();
  std::vector<int> result(forward_.input().steps.size(), 0);
  std::vector<std::vector<PlasticDual>> duals(
      functionals.size(),
      std::vector<PlasticDual>(forward_.exchange().batches().count(), PlasticDual::zero()));
  forward_.iteration().start_over();
  for (std::size_t number = waves.size(); number-- > 0;) {
    const PlasticWave& wave = waves[number];
    forward_.set_wave(number, /*changed=*/false);
    const LaneVector stiffness = forward_.nodal_stiffness(wave);
    for (std::size_t k = 0; k < functionals.size(); ++k) {
      if (wave.release && functionals[k].release.empty()) continue;
      const LaneVector added = explicit_forces(wave, functionals[k]);
      LaneVector own = unknowns.empty() ? LaneVector(forward_.unknowns(number).nodes, 3, added.lanes)
                                        : unknowns[k][number];
      const auto forces = [&](const LaneVector& adjoint, LaneVector& left) {
        run_back(number, adjoint, duals[k], &left, nullptr);
        for (std::size_t i = 0; i < left.values.size(); ++i) left.values[i] += added.values[i];
        if (wave.block && forward_.input().heated()) subtract_next(stiffness, left);
      };
      const int sweeps = forward_.iteration().solve(own, forces, /*adjoint=*/true, change);
      if (!wave.release)
        std::for_each_n(result.begin() + wave.first, wave.count,
                        [sweeps](int& most) { most = std::max(most, sweeps); });
      run_back(number, own, duals[k], nullptr, &derivatives[k]);
      if (derivatives[k].sink != nullptr) derivatives[k].sink->flush();
      if (!unknowns.empty()) unknowns[k][number] = std::move(own);
    }
  }
  forward_.save_memory();
  return result;
}

LaneVector PlasticAdjoint::explicit_forces(const PlasticWave& wave, const ProcessAdjoint& functional) const {
  const int lanes = wave.lanes(forward_.groups().index());
  const auto owned = static_cast<int>(result_.displacement.size() / 3);
  LaneVector result(owned, 3, lanes);
  if (wave.release) {
    if (lanes > 0) result.values = functional.release;
    return result;
  }
  if (wave.block) set_adjoint_load(functional, result_, *wave.block, result);
  for (double& value : result.values) value = -value;  // loads are negated derivatives
  return result;
}

/// Takes from the forces of each step those of the next one, which go on to it where material stands in both,
/// as far as both are of this group: otherwise what is left of a step would act on the void of the one
/// before.
void PlasticAdjoint::subtract_next(const LaneVector& stiffness, LaneVector& forces) {
  for (std::size_t node = 0; node < stiffness.unknowns(); ++node)
    for (int lane = 0; lane + 1 < stiffness.lanes; ++lane) {
      const double share = stiffness(node, lane) / stiffness(node, lane + 1);
      for (std::size_t i = 3 * node; i < 3 * node + 3; ++i) forces(i, lane) -= share * forces(i, lane + 1);
    }
}

void PlasticAdjoint::run_back(std::size_t wave, const LaneVector& unknowns, std::vector<PlasticDual>& dual,
                              LaneVector* forces, const ProcessDerivatives* to) {
  const std::array<const LaneVector*, 2> fields = {&forward_.unknowns(wave), &unknowns};
  const PlasticWave& own = forward_.waves()[wave];
  const std::size_t size = own.count * step_size;
  forward_.exchange().run(fields, forces,
                          [&](const PlasticBatches::Chunk& chunk,
                              std::span<const std::vector<double>> histories, std::vector<double>& of_chunk) {
                            for (std::size_t b = 0; b < chunk.batches(); ++b) {
                              const std::size_t batch = chunk.batch + b;
                              PlasticDual state = dual[batch];
                              forward_.history().run_back(
                                  own, batch, &histories[0][b * size], &histories[1][b * size],
                                  forward_.start(wave)[batch],
                                  forces != nullptr ? &of_chunk[b * size] : nullptr, state, to, records_);
                              if (to != nullptr) dual[batch] = state;
                            }
                          });
}

}  // namespace fabseq
