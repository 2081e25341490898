// SPDX-License-Identifier: MIT
#include "process/plastic_sweeps.h"

#include "fabseq/parallel/step_transpose.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr int strain_count = ElementModes::strains;
constexpr std::size_t step_size = static_cast<std::size_t>(ElementModes::components) * plastic_width;

}  // namespace

PlasticSweeps::PlasticSweeps(StepSystems<3>& systems, Release<3>* release, const PlasticInput& input)
    : systems_(systems),
      input_(input),
      batches_(systems.groups(), systems.model().elements.size()),
      exchange_(systems.model(), systems.groups(), batches_),
      material_(systems.model(), batches_, input_),
      history_(systems.model(), exchange_.modes(), material_, input.heated()),
      iteration_(systems, release, input_, material_.curves()),
      waves_(plastic_waves(systems, release != nullptr)),
      starts_(waves_.size() + 1) {
  unknowns_ = zero_unknowns();
  starts_.front() = material_.start();
}

std::vector<LaneVector> PlasticSweeps::zero_unknowns() const {
  std::vector<LaneVector> result;
  for (const PlasticWave& wave : waves_)
    result.emplace_back(static_cast<int>(systems_.model().nodes.size()), 3, wave.lanes(groups().index()));
  return result;
}

bool PlasticSweeps::fits(const std::vector<LaneVector>& unknowns) const {
  return std::ranges::equal(unknowns_, unknowns, {}, &LaneVector::lanes, &LaneVector::lanes);
}

void PlasticSweeps::start_from(std::vector<LaneVector> unknowns) {
  if (fits(unknowns)) unknowns_ = std::move(unknowns);
}

void PlasticSweeps::set_wave(std::size_t wave, bool changed) {
  material_.set_wave(waves_[wave]);
  exchange_.set_wave(waves_[wave]);
  iteration_.set_wave(waves_[wave], changed);
}

std::vector<int> PlasticSweeps::run(double change) {
  std::vector<int> result(input_.steps.size(), 0);
  iteration_.start_over();
  for (std::size_t wave = 0; wave < waves_.size(); ++wave) {
    set_wave(wave, /*changed=*/true);
    const auto forces = [&](const LaneVector& unknowns, LaneVector& left) {
      go_through(wave, unknowns, &left, nullptr);
    };
    const int sweeps = iteration_.solve(unknowns_[wave], forces, /*adjoint=*/false, change);
    if (!waves_[wave].release) std::fill_n(result.begin() + waves_[wave].first, waves_[wave].count, sweeps);
    starts_[wave + 1].resize(batches_.count());
    go_through(wave, unknowns_[wave], nullptr, &starts_[wave + 1]);
  }
  save_memory();
  return result;
}

/// Takes the states before a wave through it.
void PlasticSweeps::go_through(std::size_t wave, const LaneVector& unknowns, LaneVector* forces,
                               std::vector<PlasticPoint>* behind) const {
  const LaneVector* field = &unknowns;
  const std::size_t size = waves_[wave].count * step_size;
  exchange_.run({&field, 1}, forces,
                [&](const PlasticBatches::Chunk& chunk, std::span<const std::vector<double>> histories,
                    std::vector<double>& of_chunk) {
                  for (std::size_t b = 0; b < chunk.batches(); ++b) {
                    const std::size_t batch = chunk.batch + b;
                    PlasticPoint point = starts_[wave][batch];
                    history_.run(waves_[wave], batch, &histories[0][b * size],
                                 forces != nullptr ? &of_chunk[b * size] : nullptr, point);
                    if (behind != nullptr) (*behind)[batch] = point;
                  }
                });
}

std::vector<LaneVector> PlasticSweeps::increments() const {
  std::vector<LaneVector> result;
  for (std::size_t number = 0; number < step_waves(); ++number) {
    const PlasticWave& wave = waves_[number];
    LaneVector own = unknowns_[number];
    if (input_.heated()) {
      // Sums become increments; the step before a block's first one is another group's.
      const StepTranspose nodes(groups(), wave.blocks, static_cast<std::size_t>(own.nodes), own.components);
      std::vector<double> histories;
      nodes.to_histories(own.values, histories);
      for (std::size_t entry = histories.size(); entry-- > 0;)
        if (entry % wave.count != 0) histories[entry] -= histories[entry - 1];
      std::ranges::fill(own.values, 0.0);
      nodes.add_to_block(histories, own.values);
    }
    if (wave.block) result.push_back(std::move(own));
  }
  return result;
}

std::vector<double> PlasticSweeps::release() const {
  if (!waves_.back().release) return {};
  LaneVector all(systems_.owned_nodes(), 3, 1);
  if (groups().index() == 0) spread(unknowns_.back(), systems_.model().nodes, systems_.owned_nodes(), all);
  groups().broadcast(0, all.values);
  return std::move(all.values);
}

LaneVector PlasticSweeps::nodal_stiffness(const PlasticWave& wave) const {
  if (!wave.block || !input_.heated()) return {};
  const BlockRegion& region = systems_.blocks()[*wave.block];
  return systems_.elements().at_nodes(systems_.elements().stiffness(input_.densities, region),
                                      region.block.lanes);
}

PlasticState PlasticSweeps::state(const std::vector<PlasticPoint>& points) const {
  PlasticState result{std::vector<double>(batches_.elements() * strain_count, 0.0),
                      std::vector<double>(batches_.elements(), 0.0)};
  for (std::size_t batch = 0; batch < batches_.count(); ++batch)
    for (std::size_t lane = 0; lane < batches_.batch(batch).size(); ++lane) {
      const int element = batches_.batch(batch)[lane];
      for (int c = 0; c < strain_count; ++c)
        result.stress[static_cast<std::size_t>(element) * strain_count + c] =
            points[batch].stress[c][static_cast<int>(lane)];
      result.plastic_strain[element] = points[batch].plastic_strain[static_cast<int>(lane)];
    }
  groups().sum(result.stress);
  groups().sum(result.plastic_strain);
  return result;
}

}  // namespace fabseq
