// SPDX-License-Identifier: MIT
#include "process/plastic_wave.h"

namespace fabseq {

std::vector<PlasticWave> plastic_waves(const StepSystems<3>& systems, bool release) {
  const auto& deal = systems.deal().blocks;
  const auto own = static_cast<std::size_t>(systems.groups().index());
  std::vector<PlasticWave> result;
  for (std::size_t number = 0; number < deal.front().size(); ++number) {
    PlasticWave wave;
    wave.first = deal.front()[number].first;
    for (const std::vector<StepBlock>& blocks : deal) {
      wave.blocks.emplace_back();
      if (number >= blocks.size()) continue;
      wave.blocks.back() = {blocks[number].first - wave.first, blocks[number].lanes};
      wave.count += blocks[number].lanes;
    }
    if (number < deal[own].size()) wave.block = number;
    result.push_back(std::move(wave));
  }
  if (!release) return result;
  PlasticWave wave;
  wave.first = static_cast<int>(systems.steps().size());
  wave.count = 1;
  wave.blocks.resize(deal.size());
  wave.blocks.front() = {0, 1};
  wave.release = true;
  result.push_back(std::move(wave));
  return result;
}

}  // namespace fabseq
