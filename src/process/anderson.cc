// SPDX-License-Identifier: MIT
#include "process/anderson.h"

#include "fabseq/base/blas.h"
#include "fabseq/base/mpi.h"
#include "kernels/lanes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

/// Share of the largest diagonal entry that is added to all of the normal equations: it keeps steps that
/// hardly differ from weighing much.
constexpr double regularization = 1e-12;
/// Entries that are gone through at a time: they stay in a cache.
constexpr std::size_t piece = 4096;

/// Calls f(first entry) for eight entries at a time, and for those that are left; f has their number as its
/// template argument.
template <class Function>
void for_each_lanes(std::size_t length, Function&& f) {
  std::size_t i = 0;
  for (; i + 8 <= length; i += 8) f.template operator()<8>(i);
  for (; i < length; ++i) f.template operator()<1>(i);
}

/// Adds the products of values with two vectors.
template <class Real>
void add_products(const double* first, const double* second, const Real* values, std::size_t length,
                  double& first_sum, double& second_sum) {
  using Eight = Lanes<8>;
  // Two sums of each, since one waits for the last addition.
  std::array<Eight, 2> firsts{Eight::zero(), Eight::zero()}, seconds = firsts;
  for_each_lanes(length, [&]<int Width>(std::size_t i) {
    using Value = Lanes<Width>;
    const auto own = Value::load(values + i), of_first = Value::load(first + i) * own,
               of_second = Value::load(second + i) * own;
    if constexpr (Width == 8) {
      firsts[i / 8 % 2] += of_first;
      seconds[i / 8 % 2] += of_second;
    } else {
      first_sum += of_first[0];
      second_sum += of_second[0];
    }
  });
  const Eight first_lanes = firsts[0] + firsts[1], second_lanes = seconds[0] + seconds[1];
  for (int lane = 0; lane < 8; ++lane) {
    first_sum += first_lanes[lane];
    second_sum += second_lanes[lane];
  }
}

/// Calls f(first entry, number of entries) for one piece after the other.
template <class Function>
void for_each_piece(std::size_t entries, Function&& f) {
  for (std::size_t begin = 0; begin < entries; begin += piece) f(begin, std::min(piece, entries - begin));
}

}  // namespace

void Anderson::start(std::span<const float> weights) {
  weights_ = weights;
  has_last_ = false;
  count_ = 0;
  changes_.resize(depth_);
  products_.assign(depth_ * depth_, 0.0);
}

/// Sets where the newest change is kept: over the oldest one, once there are `depth` of them.
void Anderson::make_room(std::size_t entries) {
  newest_ = count_ < depth_ ? count_++ : (newest_ + 1) % depth_;
  changes_[newest_].step.resize(entries);
  changes_[newest_].both.resize(entries);
}

/// Sets the weighted products of a piece of the step and, if a step came before, the newest change and its
/// weighted products.
void Anderson::begin_piece(std::size_t begin, std::span<const double> step, double* of_newest,
                           double* of_step) {
  const bool keeps = count_ > 0;
  float* change = keeps ? &changes_[newest_].step[begin] : nullptr;
  float* both = keeps ? &changes_[newest_].both[begin] : nullptr;
  const float *weights = &weights_[begin], *last_step = keeps ? &last_step_[begin] : nullptr,
              *last_move = keeps ? &last_move_[begin] : nullptr;
  for_each_lanes(step.size(), [&]<int Width>(std::size_t i) {
    using Value = Lanes<Width>;
    const auto weight = Value::load(weights + i), own = Value::load(&step[i]);
    (weight * own).store(of_step + i);
    if (!keeps) return;
    (own - Value::load(last_step + i)).store(change + i);
    const auto rounded = Value::load(change + i);
    (rounded + Value::load(last_move + i)).store(both + i);
    (weight * rounded).store(of_newest + i);
  });
}

/// Weighted products: of the newest change with each change, of the step with each, of the step with itself.
/// Collective.
std::vector<double> Anderson::products(const std::vector<double>& step) {
  std::vector<double> result(2 * count_ + 1, 0.0), of_newest(piece), of_step(piece);
  for_each_piece(step.size(), [&](std::size_t begin, std::size_t length) {
    begin_piece(begin, {&step[begin], length}, of_newest.data(), of_step.data());
    for (std::size_t k = 0; k < count_; ++k)
      add_products(of_newest.data(), of_step.data(), &changes_[k].step[begin], length, result[k],
                   result[count_ + k]);
    double unused = 0.0;
    add_products(of_newest.data(), of_step.data(), &step[begin], length, unused, result.back());
  });
  sum_in_place(comm_, std::span<double>(result));
  return result;
}

/// Factors of the changes.
std::vector<double> Anderson::factors(std::span<const double> products) {
  const std::size_t count = count_;
  const std::span<const double> of_step = products.subspan(count, count);
  std::vector<double> matrix(count * count), right(of_step.begin(), of_step.end());
  for (std::size_t k = 0; k < count; ++k)
    products_[newest_ * depth_ + k] = products_[k * depth_ + newest_] = products[k];
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, products_[i * depth_ + i]);
  for (std::size_t i = 0; i < count; ++i) {
    std::copy_n(&products_[i * depth_], count, &matrix[i * count]);
    matrix[i * count + i] += regularization * largest;
  }
  // Steps that rounding makes dependent are not combined.
  const int size = static_cast<int>(count), one = 1;
  int failed = 0;
  if (count > 0) dposv_("L", &size, &one, matrix.data(), &size, right.data(), &size, &failed);
  if (failed != 0) std::ranges::fill(right, 0.0);
  return right;
}

Anderson::Norms Anderson::advance(std::vector<double>& x, const std::vector<double>& step) {
  const std::size_t entries = step.size();
  if (has_last_) make_room(entries);
  const std::vector<double> sums = products(step), factor = factors(sums);
  last_step_.resize(entries);
  last_move_.resize(entries);
  has_last_ = true;
  double x_square = 0.0;
  for_each_piece(entries, [&](std::size_t begin, std::size_t length) {
    x_square += move(begin, factor, {&step[begin], length}, &x[begin]);
  });
  return {std::sqrt(sums.back()), std::sqrt(sum(comm_, x_square))};
}

/// Moves a piece of x. Returns its square.
double Anderson::move(std::size_t begin, std::span<const double> factors, std::span<const double> step,
                      double* x) {
  const float* weights = &weights_[begin];
  float *last_step = &last_step_[begin], *last_move = &last_move_[begin];
  double result = 0.0;
  auto squares = Lanes<8>::zero();
  for_each_lanes(step.size(), [&]<int Width>(std::size_t i) {
    using Value = Lanes<Width>;
    const auto of_step = Value::load(&step[i]);
    Value way = of_step;
    for (std::size_t k = 0; k < factors.size(); ++k)
      way = way - Value::load(&changes_[k].both[begin + i]) * factors[k];
    const auto moved = Value::load(x + i) + way, square = moved * moved * Value::load(weights + i);
    moved.store(x + i);
    of_step.store(last_step + i);
    way.store(last_move + i);
    if constexpr (Width == 8)
      squares += square;
    else
      result += square[0];
  });
  for (int lane = 0; lane < 8; ++lane) result += squares[lane];
  return result;
}

}  // namespace fabseq
