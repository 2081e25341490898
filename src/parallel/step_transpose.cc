// SPDX-License-Identifier: MIT
#include "fabseq/parallel/step_transpose.h"

#include "fabseq/base/mpi_struct.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace fabseq {

namespace {

std::vector<StepTranspose::Range> shares_of(const LayerGroups& groups, std::size_t nodes) {
  std::vector<StepTranspose::Range> result;
  for (int group = 0; group < groups.count(); ++group)
    result.push_back({groups.first_of_share(nodes, group), groups.first_of_share(nodes, group + 1)});
  return result;
}

std::vector<int> starts_of(const std::vector<int>& counts) {
  std::vector<int> starts(counts.size());
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  return starts;
}

std::size_t total(const std::vector<int>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

}  // namespace

StepTranspose::StepTranspose(const LayerGroups& groups, std::vector<StepBlock> blocks,
                             std::vector<Range> ranges, int components)
    : groups_(groups), blocks_(std::move(blocks)), ranges_(std::move(ranges)), components_(components) {
  const std::size_t own_lanes = blocks_[groups_.index()].lanes;
  for (int group = 0; group < groups_.count(); ++group) {
    steps_ += blocks_[group].lanes;
    of_block_.push_back(static_cast<int>(ranges_[group].count() * own_lanes));
    in_block_.push_back(static_cast<int>(ranges_[group].begin * own_lanes));
    of_range_.push_back(static_cast<int>(range().count() * blocks_[group].lanes));
  }
  of_block_starts_ = starts_of(of_block_);
  of_range_starts_ = starts_of(of_range_);
}

StepTranspose::StepTranspose(const LayerGroups& groups, std::vector<StepBlock> blocks, std::size_t nodes,
                             int components)
    : StepTranspose(groups, std::move(blocks), shares_of(groups, nodes), components) {}

template <class Function>
void StepTranspose::for_each_piece(Function&& f) const {
  std::size_t entry = 0;
  for (const StepBlock& block : blocks_) {
    if (block.lanes == 0) continue;
    for (std::size_t i = 0; i < range().count() * components_; ++i, entry += block.lanes) f(i, block, entry);
  }
}

void StepTranspose::to_histories(std::span<const double> block, std::vector<double>& histories) const {
  histories.resize(size_of_histories());
  range_message_.resize(total(of_range_) * components_);
  const MpiType node = contiguous_type(static_cast<int>(components_), MPI_DOUBLE);
  MPI_Alltoallv(block.data(), of_block_.data(), in_block_.data(), node, range_message_.data(),
                of_range_.data(), of_range_starts_.data(), node, groups_.across());
  for_each_piece([&](std::size_t i, const StepBlock& steps, std::size_t entry) {
    std::copy_n(&range_message_[entry], steps.lanes, &histories[i * steps_ + steps.first]);
  });
}

void StepTranspose::add_to_block(std::span<const double> histories, std::span<double> block) const {
  range_message_.resize(total(of_range_) * components_);
  block_message_.resize(total(of_block_) * components_);
  for_each_piece([&](std::size_t i, const StepBlock& steps, std::size_t entry) {
    std::copy_n(&histories[i * steps_ + steps.first], steps.lanes, &range_message_[entry]);
  });
  const MpiType node = contiguous_type(static_cast<int>(components_), MPI_DOUBLE);
  MPI_Alltoallv(range_message_.data(), of_range_.data(), of_range_starts_.data(), node, block_message_.data(),
                of_block_.data(), of_block_starts_.data(), node, groups_.across());
  for (int group = 0; group < groups_.count(); ++group) {
    const double* from = block_message_.data() + of_block_starts_[group] * components_;
    double* to = block.data() + in_block_[group] * components_;
    for (std::size_t i = 0; i < of_block_[group] * components_; ++i) to[i] += from[i];
  }
}

}  // namespace fabseq
