// SPDX-License-Identifier: MIT
#include "mma/mma_variables.h"

#include "fabseq/base/blas.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Rows are far apart in memory: the processor does not foresee that the next one follows.
void prefetch(std::span<const double> values) {
  constexpr std::size_t cache_line = 64 / sizeof(double);
  for (std::size_t k = 0; k < values.size(); k += cache_line) __builtin_prefetch(&values[k]);
}

double dot(std::size_t count, const double* a, const double* b) {
  const int n = static_cast<int>(count), one = 1;
  return ddot_(&n, a, &one, b, &one);
}

}  // namespace

MmaBox::MmaBox(std::size_t local)
    : width(local),
      upper_distance(local, 2.0),
      lower_distance(local, 2.0),
      alpha(local, -1.0),
      beta(local, 1.0),
      curvature(local, 1.0) {}

MmaVariables::MmaVariables(MPI_Comm comm, const MmaBox& box, std::span<const double> objective_gradient,
                           std::span<const std::span<const double>> gradients)
    : comm_(comm),
      box_(box),
      objective_gradient_(objective_gradient),
      gradients_(gradients),
      scaled_rows_(gradients.size() + 1, block_size) {
  for (auto* vector : {&v_, &plain_, &curved_, &plain_direction_, &curved_direction_})
    vector->assign(box.size(), 0.0);
  const std::size_t rows = gradients.size() + 1;
  sums_.schur.resize(rows * rows);
  sums_.change.resize(gradients.size());
  sums_.wall.resize(gradients.size());
}

bool MmaVariables::start(std::span<const double> lambda) {
  for (std::size_t begin = 0; begin < box_.size(); begin += block_size)
    combine(begin, lambda, 1.0, plain_, curved_);
  for (std::size_t j = 0; j < box_.size(); ++j) v_[j] = 0.5 * (box_.alpha[j] + box_.beta[j]);
  const bool finite =
      std::all_of(curved_.begin(), curved_.end(), [](double value) { return std::isfinite(value); });
  return !any(comm_, !finite);
}

void MmaVariables::set_direction(std::span<const double> lambda_direction) {
  lambda_direction_.assign(lambda_direction.begin(), lambda_direction.end());
  direction_is_new_ = true;
}

void MmaVariables::advance(double t) {
  for (std::size_t j = 0; j < box_.size(); ++j) {
    plain_[j] += t * plain_direction_[j];
    curved_[j] += t * curved_direction_[j];
  }
}

// S and T of a block for multipliers `lambda` and that of the objective.
void MmaVariables::combine(std::size_t begin, std::span<const double> lambda, double objective,
                           std::vector<double>& plain, std::vector<double>& curved) const {
  double weight = objective;
  for (const double value : lambda) weight += value;
  const std::size_t count = std::min(block_size, box_.size() - begin);
  MmaBlock::Array sum, size;
  for (std::size_t k = 0; k < count; ++k) {
    sum[k] = objective * objective_gradient_[begin + k];
    size[k] = objective * std::abs(objective_gradient_[begin + k]);
  }
  for (std::size_t i = 0; i < lambda.size(); ++i) {
    const double* gradient = gradients_[i].data() + begin;
    const double factor = lambda[i];
    if (i + 1 < lambda.size()) prefetch(gradients_[i + 1].subspan(begin, count));
    for (std::size_t k = 0; k < count; ++k) {
      sum[k] += factor * gradient[k];
      size[k] += factor * std::abs(gradient[k]);
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    plain[begin + k] = sum[k];
    curved[begin + k] = mma_bulge_factor * size[k] + box_.curvature[begin + k] * weight;
  }
}

const MmaSums& MmaVariables::evaluate(double t, double barrier) {
  std::fill(sums_.schur.begin(), sums_.schur.end(), 0.0);
  std::fill(sums_.change.begin(), sums_.change.end(), 0.0);
  std::fill(sums_.wall.begin(), sums_.wall.end(), 0.0);
  MmaBlock block;
  for (std::size_t begin = 0; begin < box_.size(); begin += block_size) {
    block.count = std::min(block_size, box_.size() - begin);
    // The rows' gradients come from memory here, and are in the cache for add_rows().
    if (direction_is_new_) combine(begin, lambda_direction_, 0.0, plain_direction_, curved_direction_);
    load(begin, t, block);
    block.minimize(barrier);
    block.expand(barrier);
    std::copy_n(block.v.begin(), block.count, v_.begin() + static_cast<std::ptrdiff_t>(begin));
    add_rows(begin, block);
    constexpr std::size_t step = RowProducts::column_step;
    scaled_rows_.add_to(sums_.schur, (block.count + step - 1) / step * step);
  }
  direction_is_new_ = false;
  reduce();
  return sums_;
}

void MmaVariables::load(std::size_t begin, double t, MmaBlock& block) const {
  for (std::size_t k = 0; k < block.count; ++k) {
    const std::size_t j = begin + k;
    const double curved = curved_[j] + t * curved_direction_[j];
    // Rounding must not take away what T >= |S| / 2 grants.
    block.ratio[k] = std::clamp(0.5 * (plain_[j] + t * plain_direction_[j]) / curved, -1.0, 1.0);
    block.curved[k] = curved;
    block.width[k] = box_.width[j];
    block.upper[k] = box_.upper_distance[j];
    block.lower[k] = box_.lower_distance[j];
    block.alpha[k] = box_.alpha[j];
    block.beta[k] = box_.beta[j];
    block.curvature[k] = box_.curvature[j];
    block.v[k] = v_[j];
  }
}

// The block's columns of G D^(-1/2) and kappa for the rank-k update, and the rows' own change.
void MmaVariables::add_rows(std::size_t begin, const MmaBlock& block) {
  const std::size_t m = gradients_.size(), count = block.count;
  MmaBlock::Array magnitude;
  for (std::size_t i = 0; i < m; ++i) {
    const double* gradient = gradients_[i].data() + begin;
    double* __restrict scaled = scaled_rows_.row(i);
    for (std::size_t k = 0; k < count; ++k) {
      magnitude[k] = std::abs(gradient[k]);
      scaled[k] =
          gradient[k] * block.even_slope[k] + magnitude[k] * block.bulge_slope[k] + block.curvature_slope[k];
    }
    std::fill(scaled + count, scaled + block_size, 0.0);
    sums_.change[i] += block.curvature_change + dot(count, gradient, block.even.data()) +
                       dot(count, magnitude.data(), block.bulge.data());
    sums_.wall[i] += block.curvature_wall + dot(count, magnitude.data(), block.wall.data());
  }
  double* const last = scaled_rows_.row(m);
  std::fill(std::copy_n(block.kappa.begin(), count, last), last + block_size, 0.0);
}

// One message: the lower triangle packed, the rows' own sums.
void MmaVariables::reduce() {
  const std::size_t rows = gradients_.size() + 1;
  message_.clear();
  for (std::size_t column = 0; column < rows; ++column) {
    const double* begin = sums_.schur.data() + column * rows;
    message_.insert(message_.end(), begin + column, begin + rows);
  }
  message_.insert(message_.end(), sums_.change.begin(), sums_.change.end());
  message_.insert(message_.end(), sums_.wall.begin(), sums_.wall.end());
  sum_in_place(comm_, message_);

  const double* next = message_.data();
  for (std::size_t column = 0; column < rows; ++column) {
    for (std::size_t row = column; row < rows; ++row) sums_.schur[column * rows + row] = *next++;
  }
  for (double& value : sums_.change) value = *next++;
  for (double& value : sums_.wall) value = *next++;
}

// Rows are convex in each variable and so largest at one of its ends.
std::vector<double> largest_changes(MPI_Comm comm, const MmaBox& box,
                                    std::span<const std::span<const double>> gradients) {
  constexpr std::size_t block_size = MmaBlock::size;
  std::vector<double> changes(gradients.size());
  std::array<double, block_size> even_up, bulge_up, even_down, bulge_down, curvature, change;
  for (std::size_t begin = 0; begin < box.size(); begin += block_size) {
    const std::size_t count = std::min(block_size, box.size() - begin);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t j = begin + k;
      const auto set = [&](double v, double& even, double& bulge) {
        const double a = v * box.upper_distance[j] / (box.upper_distance[j] - v);
        const double b = v * box.lower_distance[j] / (box.lower_distance[j] + v);
        even = 0.5 * (a + b) * box.width[j];
        bulge = (a - b) * box.width[j];
      };
      set(box.beta[j], even_up[k], bulge_up[k]);
      set(box.alpha[j], even_down[k], bulge_down[k]);
      curvature[k] = box.curvature[j];
    }
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      const double* gradient = gradients[i].data() + begin;
      for (std::size_t k = 0; k < count; ++k) {
        const double size = mma_bulge_factor * std::abs(gradient[k]) + curvature[k];
        change[k] = std::max(gradient[k] * even_up[k] + size * bulge_up[k],
                             gradient[k] * even_down[k] + size * bulge_down[k]);
      }
      for (std::size_t k = 0; k < count; ++k) changes[i] += change[k];
    }
  }
  sum_in_place(comm, changes);
  return changes;
}

}  // namespace fabseq
