// SPDX-License-Identifier: MIT
/// \file
/// Definitions of LaneCg, for the files that instantiate it.
#pragma once

#include "cg/lane_cg.h"
#include "cg/lane_cg_cycle_impl.h"
#include "cg/lane_cg_half_impl.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/stop.h"
#include "kernels/flush_to_zero.h"
#include "multigrid/lane_multigrid_impl.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

template <class Problem, int Width>
LaneCg<Problem, Width>::LaneCg(LaneHierarchy<Problem::dim>& hierarchy, const Problem& problem,
                               const LaneCycle& cycle)
    : hierarchy_(hierarchy), problem_(problem), cycle_(cycle) {}

template <class Problem, int Width>
void LaneCg<Problem, Width>::allocate() {
  if (matrix_) return;
  matrix_ = std::make_unique<Operator>(hierarchy_.level(0), problem_);
  multigrid_ = std::make_unique<Multigrid>(hierarchy_, problem_, cycle_);
  for (LaneArray* array : {&direction_, &image_}) array->resize(matrix_->size());
  for (auto* array : {&rounded_residual_, &preconditioned_}) array->resize(matrix_->size());
}

template <class Problem, int Width>
void LaneCg<Problem, Width>::release_memory() {
  matrix_.reset();
  multigrid_.reset();
  half_.reset();
  for (LaneArray* array :
       {&direction_, &image_, &corrected_, &left_over_, &handed_residual_, &handed_solution_})
    free_memory(*array);
  for (auto* array : {&rounded_residual_, &preconditioned_}) free_memory(*array);
}

template <class Problem, int Width>
void LaneCg<Problem, Width>::set_up(Islands& islands) {
  set_up_with(matrix_->coefficients());
  if constexpr (Problem::own_operators) {
    if (!cycle_.islands || hierarchy_.count() == 1) return;
    if (islands.empty()) {
      if (!island_map_) island_map_ = std::make_unique<IslandMap<Problem::dim>>(matrix_->level());
      islands_.set_up(*matrix_, island_map_->find(matrix_->coefficients(), Width));
      islands = islands_.known();
    } else {
      islands_.take(islands);
    }
  }
}

template <class Problem, int Width>
std::vector<LaneOutcome> LaneCg<Problem, Width>::solve(LaneArray& load, LaneArray& solution, int lanes,
                                                       const LaneStop& stop) {
  if (stop.one_cycle && islands_.empty() && free_motions_ == nullptr)
    return cycle_once(load, solution, lanes);
  solution.assign(load.size(), 0.0);
  Progress progress;
  return solve_from(progress, load, solution, lanes, stop);
}

template <class Problem, int Width>
std::vector<LaneOutcome> LaneCg<Problem, Width>::improve(LaneArray& load, LaneArray& solution, int lanes,
                                                         const LaneStop& stop, const Scalars& smallest) {
  Progress progress;
  progress.guessed = true;
  progress.known_smallest = smallest;
  return solve_from(progress, load, solution, lanes, stop);
}

template <class Problem, int Width>
std::vector<LaneOutcome> LaneCg<Problem, Width>::solve_from(Progress& progress, LaneArray& load,
                                                            LaneArray& solution, int lanes,
                                                            const LaneStop& stop) {
  const FlushToZero flush_to_zero;
  Scalars scales = start(progress, load, solution, lanes);
  iterate(progress, load, solution, stop);
  for (double& scale : scales) scale = 1.0 / scale;
  multiply(solution, scales);
  return {progress.outcome.begin(), progress.outcome.begin() + lanes};
}

/// Multiplies every lane by its factor.
template <class Problem, int Width>
void LaneCg<Problem, Width>::multiply(LaneArray& vector, const Scalars& factors) {
  const auto all = Lanes<Width>::load(factors.data());
  for (std::size_t i = 0; i < vector.size(); i += Width)
    (Lanes<Width>::load(&vector[i]) * all).store(&vector[i]);
}

/// Clears the load at held nodes. Returns a power of two for each lane that scales it to about 1, so that
/// single precision holds its residual down to any tolerance.
template <class Problem, int Width>
LaneScalars<Width> LaneCg<Problem, Width>::scales_of(LaneArray& load) const {
  matrix_->clear_held(load.data());
  Scalars squares = matrix_->dot(load.data(), load.data());
  sum_in_place(matrix_->level().comm, squares);
  Scalars scales;
  for (int lane = 0; lane < Width; ++lane) {
    const double size = std::sqrt(squares[lane]);
    scales[lane] = std::isnormal(size) ? std::exp2(-std::ilogb(size)) : 1.0;
  }
  return scales;
}

/// Scales the load of each lane, takes off what a guess makes of it, and solves for rigid motions of islands.
/// Returns the scales.
template <class Problem, int Width>
LaneScalars<Width> LaneCg<Problem, Width>::start(Progress& progress, LaneArray& load, LaneArray& solution,
                                                 int lanes) {
  const Scalars scales = scales_of(load);
  for (int lane = 0; lane < lanes; ++lane) {
    progress.active[lane] = positive(lane);
    progress.outcome[lane].residual = 1.0;
    if constexpr (Problem::own_operators) progress.outcome[lane].has_islands = islands_.count(lane) > 0;
  }
  multiply(load, scales);
  if (progress.guessed) {
    multiply(solution, scales);
    take_guess(solution, load);
  }
  if constexpr (Problem::own_operators) {
    if (!islands_.empty()) {
      corrected_.assign(load.size(), 0.0);
      islands_.add_correction(matrix_->level(), load.data(), corrected_.data());
      for (std::size_t i = 0; i < load.size(); ++i) solution[i] += corrected_[i];
      subtract_image(corrected_, load);
    }
  }
  if (progress.guessed || !islands_.empty()) progress.length = matrix_->dot(solution.data(), solution.data());
  std::copy(load.begin(), load.end(), rounded_residual_.begin());
  return scales;
}

/// Multiplies the guess of each lane by the factor that leaves the least energy of its error, so that no
/// guess is worse than zero: loads may have changed by far, or have vanished. residual -= K guess
template <class Problem, int Width>
void LaneCg<Problem, Width>::take_guess(LaneArray& guess, LaneArray& residual) {
  matrix_->clear_held(guess.data());
  std::array<Scalars, 2> sums{matrix_->dot(guess.data(), residual.data()), set_image(guess)};
  sum_in_place(matrix_->level().comm, std::span<double>(sums.front().data(), 2 * Width));
  const auto& [work, energy] = sums;
  Scalars factors;
  for (int lane = 0; lane < Width; ++lane)
    factors[lane] = energy[lane] > 0.0 ? work[lane] / energy[lane] : 0.0;
  multiply(guess, factors);
  multiply(image_, factors);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= image_[i];
}

/// residual -= K vector
template <class Problem, int Width>
void LaneCg<Problem, Width>::subtract_image(const LaneArray& vector, LaneArray& residual) {
  (void)set_image(vector);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= image_[i];
}

template <class Problem, int Width>
void LaneCg<Problem, Width>::iterate(Progress& progress, LaneArray& residual, LaneArray& solution,
                                     const LaneStop& stop) {
  const MPI_Comm comm = matrix_->level().comm;
  while (progress.any_active()) {
    multigrid_->be_patient(progress.iteration >= cycle_.patience);
    precondition(residual);
    // The image is none before the first iteration: what it adds then is not used.
    const auto products =
        matrix_->dots(preconditioned_.data(), preconditioned_.data(), residual.data(), image_.data());
    // A request to stop travels along: all ranks follow it in the same iteration.
    const Scalars stops{stop_requested() ? 1.0 : 0.0};
    std::array<Scalars, 5> sums{products[0], products[1], products[2], progress.length, stops};
    sum_in_place(comm, std::span<double>(sums.front().data(), 4 * Width + 1));
    const auto& [size, decrease, overlap, length, asked] = sums;
    if (asked[0] > 0.0) throw_stopped(comm);
    progress.judge(size, length, stop);
    if (!progress.any_active() || progress.iteration == stop.max_iterations) break;
    Scalars beta, alpha;
    for (int lane = 0; lane < Width; ++lane) {
      const bool moves = progress.active[lane] && progress.energy[lane] > 0.0;
      beta[lane] = moves ? -overlap[lane] / progress.energy[lane] : 0.0;
      progress.decrease[lane] = decrease[lane];
    }
    update_direction(beta, progress.iteration == 0);
    progress.energy = set_image(direction_);
    sum_in_place(comm, progress.energy);
    for (int lane = 0; lane < Width; ++lane) {
      const bool moves = progress.active[lane] && progress.energy[lane] > 0.0;
      alpha[lane] = moves ? progress.decrease[lane] / progress.energy[lane] : 0.0;
      progress.spectrum[lane].add(alpha[lane], beta[lane]);
    }
    progress.length = advance(alpha, residual, solution);
    balance(residual);
    ++progress.iteration;
    progress.end_within_reach(alpha, stop);
    if (narrow(progress, residual, solution, stop)) return;
  }
}

template <class Problem, int Width>
void LaneCg<Problem, Width>::precondition(const LaneArray& residual) {
  multigrid_->apply(rounded_residual_.data(), preconditioned_.data());
  if constexpr (may_be_free)
    if (free_motions_ != nullptr) free_motions_->remove(preconditioned_);
  if constexpr (Problem::own_operators) {
    if (islands_.empty()) return;
    corrected_.assign(preconditioned_.begin(), preconditioned_.end());
    left_over_.resize(residual.size());
    matrix_->apply(corrected_.data(), left_over_.data());
    for (std::size_t i = 0; i < residual.size(); ++i) left_over_[i] = residual[i] - left_over_[i];
    islands_.add_correction(matrix_->level(), left_over_.data(), preconditioned_.data());
  }
}

/// direction = preconditioned residual + beta direction
template <class Problem, int Width>
void LaneCg<Problem, Width>::update_direction(const Scalars& beta, bool first) {
  using Value = Lanes<Width>;
  const auto factor = Value::load(beta.data());
  for (std::size_t i = 0; i < direction_.size(); i += Width) {
    auto direction = Value::load(&preconditioned_[i]);
    if (!first) direction += factor * Value::load(&direction_[i]);
    direction.store(&direction_[i]);
  }
}

/// image = K vector; this rank's part of their product.
template <class Problem, int Width>
LaneScalars<Width> LaneCg<Problem, Width>::set_image(const LaneArray& vector) {
  Scalars products = matrix_->apply(vector.data(), image_.data());
  if constexpr (!Problem::own_operators)
    if (!diagonal_.empty()) add_diagonal(vector, products);
  return products;
}

/// The vector is 0 at held nodes.
template <class Problem, int Width>
void LaneCg<Problem, Width>::add_diagonal(const LaneArray& vector, Scalars& products) {
  using Value = Lanes<Width>;
  auto sum = Value::zero();
  std::size_t node = 0;
  const auto add_to = [&](std::size_t end, bool counted) {
    for (; node < end; ++node) {
      const auto value = Value::load(&vector[node * Width]), added = value * diagonal_[node];
      (Value::load(&image_[node * Width]) + added).store(&image_[node * Width]);
      if (counted) sum += value * added;
    }
  };
  for (const auto& range : matrix_->level().counted) {
    add_to(range.begin, false);
    add_to(range.end, true);
  }
  add_to(diagonal_.size(), false);
  for (int lane = 0; lane < Width; ++lane) products[lane] += sum[lane];
}

/// solution += alpha direction, residual -= alpha image; this rank's part of |solution|^2.
template <class Problem, int Width>
LaneScalars<Width> LaneCg<Problem, Width>::advance(const Scalars& alpha, LaneArray& residual,
                                                   LaneArray& solution) {
  using Value = Lanes<Width>;
  constexpr std::size_t node_values = Operator::node_values;
  const auto factor = Value::load(alpha.data());
  auto squares = Value::zero();
  std::size_t next = 0;
  const auto advance_to = [&](std::size_t end, bool counted) {
    for (; next < end; next += Width) {
      const auto value = Value::load(&solution[next]) + factor * Value::load(&direction_[next]);
      value.store(&solution[next]);
      if (counted) squares += value * value;
      const auto left = Value::load(&residual[next]) - factor * Value::load(&image_[next]);
      left.store(&residual[next]);
      left.store(&rounded_residual_[next]);
    }
  };
  for (const auto& range : matrix_->level().counted) {
    advance_to(range.begin * node_values, false);
    advance_to(range.end * node_values, true);
  }
  advance_to(residual.size(), false);
  Scalars result;
  squares.store(result.data());
  return result;
}

/// Resultants that rounding leaves would stay, and outweigh what is left of the residual in the end.
template <class Problem, int Width>
void LaneCg<Problem, Width>::balance(LaneArray& residual) {
  if constexpr (may_be_free) {
    if (free_motions_ == nullptr) return;
    free_motions_->balance(residual);
    std::copy(residual.begin(), residual.end(), rounded_residual_.begin());
  }
}

}  // namespace fabseq
