// SPDX-License-Identifier: MIT
#include "fabseq/parallel/step_transpose.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

std::vector<int> starts_of(const std::vector<int>& counts) {
  std::vector<int> starts(counts.size());
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  return starts;
}

std::size_t total(const std::vector<int>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

/// Sends `outgoing` to the copies, and returns what they send.
std::vector<double> exchange(const LayerGroups& groups, const std::vector<double>& outgoing,
                             const std::vector<int>& sent, const std::vector<int>& received) {
  std::vector<double> incoming(total(received));
  MPI_Alltoallv(outgoing.data(), sent.data(), starts_of(sent).data(), MPI_DOUBLE, incoming.data(),
                received.data(), starts_of(received).data(), MPI_DOUBLE, groups.across());
  return incoming;
}

}  // namespace

StepTranspose::StepTranspose(const LayerGroups& groups, const StepDeal& deal, std::size_t elements,
                             int components, std::size_t most)
    : groups_(groups), deal_(deal.blocks), elements_(elements), components_(components) {
  for (const std::vector<StepBlock>& blocks : deal_) {
    steps_of_.push_back(0);
    for (const StepBlock& block : blocks) steps_of_.back() += block.lanes;
    steps_ += steps_of_.back();
  }
  // The most that a rank holds: blocks of all elements, or histories of the largest share.
  const std::size_t largest_share = (elements_ + groups_.count() - 1) / groups_.count();
  const std::size_t own_steps = *std::max_element(steps_of_.begin(), steps_of_.end());
  const std::size_t held = components_ * std::max(elements_ * own_steps, largest_share * steps_);
  passes_ = std::max<std::size_t>(1, (held + most - 1) / most);
  passes_ = std::min(passes_, std::max<std::size_t>(1, largest_share));
}

StepTranspose::Range StepTranspose::range(int group, std::size_t pass) const {
  const std::size_t first = start(group), count = start(group + 1) - first;
  return {first + count * pass / passes_, first + count * (pass + 1) / passes_};
}

StepTranspose::Counts StepTranspose::counts(std::size_t pass) const {
  Counts result;
  const Range own = range(groups_.index(), pass);
  for (int group = 0; group < groups_.count(); ++group) {
    const Range other = range(group, pass);
    result.blocks.push_back(
        static_cast<int>((other.end - other.begin) * components_ * steps_of_[groups_.index()]));
    result.histories.push_back(static_cast<int>((own.end - own.begin) * components_ * steps_of_[group]));
  }
  return result;
}

template <class Function>
void StepTranspose::for_each_slice(int group, std::size_t pass, Function&& f) const {
  const Range elements = range(group, pass);
  const std::vector<StepBlock>& blocks = deal_[groups_.index()];
  for (std::size_t number = 0; number < blocks.size(); ++number) {
    const std::size_t of_element = components_ * blocks[number].lanes;
    f(number, elements.begin * of_element, (elements.end - elements.begin) * of_element);
  }
}

template <class Function>
void StepTranspose::for_each_entry(std::size_t pass, Function&& f) const {
  const Range elements = range(groups_.index(), pass);
  for (const std::vector<StepBlock>& blocks : deal_)
    for (const StepBlock& block : blocks)
      for (std::size_t element = elements.begin; element < elements.end; ++element)
        for (std::size_t component = 0; component < components_; ++component)
          for (int lane = 0; lane < block.lanes; ++lane)
            f(((element - first_element()) * steps_ + block.first + lane) * components_ + component);
}

std::vector<double> StepTranspose::to_histories(std::span<const std::vector<double>> blocks) const {
  std::vector<double> histories(elements_of_share() * steps_ * components_), outgoing;
  for (std::size_t pass = 0; pass < passes_; ++pass) {
    const Counts count = counts(pass);
    outgoing.clear();
    for (int group = 0; group < groups_.count(); ++group)
      for_each_slice(group, pass, [&](std::size_t number, std::size_t begin, std::size_t length) {
        const auto first = blocks[number].begin() + static_cast<std::ptrdiff_t>(begin);
        outgoing.insert(outgoing.end(), first, first + static_cast<std::ptrdiff_t>(length));
      });
    const std::vector<double> incoming = exchange(groups_, outgoing, count.blocks, count.histories);
    auto next = incoming.begin();
    for_each_entry(pass, [&](std::size_t entry) { histories[entry] = *next++; });
  }
  return histories;
}

std::vector<std::vector<double>> StepTranspose::to_blocks(std::span<const double> histories) const {
  std::vector<std::vector<double>> blocks;
  for (const StepBlock& block : deal_[groups_.index()]) blocks.emplace_back(size_of(block));
  std::vector<double> outgoing;
  for (std::size_t pass = 0; pass < passes_; ++pass) {
    const Counts count = counts(pass);
    outgoing.clear();
    for_each_entry(pass, [&](std::size_t entry) { outgoing.push_back(histories[entry]); });
    const std::vector<double> incoming = exchange(groups_, outgoing, count.histories, count.blocks);
    auto next = incoming.begin();
    for (int group = 0; group < groups_.count(); ++group)
      for_each_slice(group, pass, [&](std::size_t number, std::size_t begin, std::size_t length) {
        std::copy_n(next, length, blocks[number].begin() + static_cast<std::ptrdiff_t>(begin));
        next += static_cast<std::ptrdiff_t>(length);
      });
  }
  return blocks;
}

}  // namespace fabseq
