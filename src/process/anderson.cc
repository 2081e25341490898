// SPDX-License-Identifier: MIT
#include "process/anderson.h"

#include "fabseq/base/blas.h"
#include "fabseq/base/mpi.h"
#include "kernels/lanes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// Share of the largest diagonal entry that is added to all of the normal equations: it keeps steps that
/// hardly differ from weighing much.
constexpr double regularization = 1e-12;
/// Entries that are gone through at a time: they stay in a cache.
constexpr std::size_t piece = 2048;

}  // namespace

/// Changes to the step just found; the oldest one makes room.
void Anderson::keep_change(const std::vector<double>& step) {
  Change change;
  if (changes_.size() == depth_) {
    change = std::move(changes_.front());
    changes_.pop_front();
  }
  change.step.resize(step.size());
  change.both.resize(step.size());
  for (std::size_t i = 0; i < step.size(); ++i) {
    const auto of_step = static_cast<float>(step[i] - last_step_[i]);
    change.step[i] = of_step;
    change.both[i] = of_step + last_move_[i];
  }
  changes_.push_back(std::move(change));
}

/// Factors of the changes, and the square of the step, from [change][changes up to it, step], step . step.
/// Collective.
std::vector<double> Anderson::factors(std::vector<double> sums, double& square) const {
  sum_in_place(comm_, std::span<double>(sums));
  const std::size_t count = changes_.size();
  std::vector<double> matrix(count * count), right(count);
  double largest = 0.0;
  auto next = sums.cbegin();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) matrix[i * count + j] = matrix[j * count + i] = *next++;
    right[i] = *next++;
    largest = std::max(largest, matrix[i * count + i]);
  }
  square = *next;
  for (std::size_t i = 0; i < count; ++i) matrix[i * count + i] += regularization * largest;
  // Steps that rounding makes dependent are not combined.
  const int size = static_cast<int>(count), one = 1;
  int failed = 0;
  if (count > 0) dposv_("L", &size, &one, matrix.data(), &size, right.data(), &size, &failed);
  if (failed != 0) std::ranges::fill(right, 0.0);
  return right;
}

Anderson::Norms Anderson::advance(std::vector<double>& x, const std::vector<double>& step) {
  if (has_last_) keep_change(step);
  const std::size_t count = changes_.size(), entries = step.size();
  std::vector<double> sums(count * (count + 3) / 2 + 1, 0.0), weighted(piece);
  for (std::size_t begin = 0; begin < entries; begin += piece) {
    const std::size_t length = std::min(piece, entries - begin);
    const auto add_product = [&](const auto* values, double& sum) {
      auto lanes = Lanes<8>::zero();
      std::size_t i = 0;
      for (; i + 8 <= length; i += 8) lanes += Lanes<8>::load(&weighted[i]) * Lanes<8>::load(values + i);
      for (; i < length; ++i) sum += weighted[i] * values[i];
      for (int lane = 0; lane < 8; ++lane) sum += lanes[lane];
    };
    const auto weigh = [&](const auto* values) {
      for (std::size_t i = 0; i < length; ++i) weighted[i] = weights_[begin + i] * values[i];
    };
    std::size_t next = 0;
    for (std::size_t k = 0; k < count; ++k) {
      weigh(&changes_[k].step[begin]);
      for (std::size_t j = 0; j <= k; ++j) add_product(&changes_[j].step[begin], sums[next++]);
      add_product(&step[begin], sums[next++]);
    }
    weigh(&step[begin]);
    add_product(&step[begin], sums[next]);
  }
  double step_square = 0.0, x_square = 0.0;
  const std::vector<double> factor = factors(std::move(sums), step_square);
  last_step_.resize(entries);
  last_move_.resize(entries);
  has_last_ = true;
  std::vector<double> move(piece);
  for (std::size_t begin = 0; begin < entries; begin += piece) {
    const std::size_t length = std::min(piece, entries - begin);
    std::copy_n(step.begin() + static_cast<std::ptrdiff_t>(begin), length, move.begin());
    for (std::size_t k = 0; k < count; ++k) {
      const float* both = &changes_[k].both[begin];
      for (std::size_t i = 0; i < length; ++i) move[i] -= factor[k] * both[i];
    }
    for (std::size_t i = 0; i < length; ++i) {
      double& own = x[begin + i];
      own += move[i];
      x_square += weights_[begin + i] * own * own;
      last_step_[begin + i] = static_cast<float>(step[begin + i]);
      last_move_[begin + i] = static_cast<float>(move[i]);
    }
  }
  return {std::sqrt(step_square), std::sqrt(sum(comm_, x_square))};
}

}  // namespace fabseq
