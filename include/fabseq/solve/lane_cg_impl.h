/// \file
/// Definitions of LaneCg, for the files that instantiate it.
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/base/stop.h"
#include "fabseq/solve/lane_cg.h"
#include "fabseq/solve/lane_multigrid_impl.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

template <class Problem, int Width>
LaneCg<Problem, Width>::LaneCg(LaneHierarchy<Problem::dim>& hierarchy, const Problem& problem,
                               const LaneCycle& cycle)
    : hierarchy_(hierarchy), problem_(problem), cycle_(cycle), multigrid_(hierarchy, problem, cycle) {
  const std::size_t size = multigrid_.finest().size();
  preconditioned_.resize(size);
  direction_.resize(size);
  image_.resize(size);
}

template <class Problem, int Width>
void LaneCg<Problem, Width>::set_up() {
  positive_ = multigrid_.set_up();
}

template <class Problem, int Width>
std::vector<LaneOutcome> LaneCg<Problem, Width>::solve(LaneArray& load, LaneArray& solution, int lanes,
                                                       const LaneStop& stop) {
  solution.assign(load.size(), 0.0);
  multigrid_.finest().clear_held(load.data());
  State state;
  for (int lane = 0; lane < lanes; ++lane) {
    state.active[lane] = Problem::own_operators ? positive_[lane] : positive_[0];
    state.outcome[lane].residual = 1.0;
  }
  iterate(state, load, solution, stop);
  return {state.outcome.begin(), state.outcome.begin() + lanes};
}

/// Ends lanes whose preconditioned residual is small enough, or no number.
template <class Problem, int Width>
void LaneCg<Problem, Width>::judge(State& state, const Scalars& size, const LaneStop& stop) const {
  for (int lane = 0; lane < Width; ++lane) {
    if (!state.active[lane]) continue;
    if (state.iteration == 0) state.start[lane] = size[lane];
    LaneOutcome& outcome = state.outcome[lane];
    outcome.iterations = state.iteration;
    outcome.finite = std::isfinite(size[lane]);
    outcome.residual = state.start[lane] == 0.0 ? 0.0 : std::sqrt(size[lane] / state.start[lane]);
    outcome.converged =
        outcome.finite && outcome.residual <= stop.tolerance &&
        outcome.residual <= stop.error_factor * stop.tolerance * state.spectrum[lane].smallest();
    if (outcome.converged || !outcome.finite) state.active[lane] = false;
  }
}

template <class Problem, int Width>
void LaneCg<Problem, Width>::iterate(State& state, LaneArray& rest, LaneArray& solution,
                                     const LaneStop& stop) {
  auto& matrix = multigrid_.finest();
  const MPI_Comm comm = matrix.level().comm;
  const auto any_active = [&] {
    return std::find(state.active.begin(), state.active.end(), true) != state.active.end();
  };
  while (any_active()) {
    multigrid_.be_patient(state.iteration >= cycle_.patience);
    multigrid_.apply(rest.data(), preconditioned_.data());
    std::array<double, static_cast<std::size_t>(3) * Width + 1> sums{};
    const Scalars size = matrix.dot(preconditioned_.data(), preconditioned_.data());
    const Scalars decrease = matrix.dot(rest.data(), preconditioned_.data());
    std::copy(size.begin(), size.end(), sums.begin());
    std::copy(decrease.begin(), decrease.end(), sums.begin() + Width);
    if (state.iteration > 0) {
      const Scalars overlap = matrix.dot(preconditioned_.data(), image_.data());
      std::copy(overlap.begin(), overlap.end(), sums.begin() + 2 * Width);
    }
    sums.back() = stop_requested() ? 1.0 : 0.0;  // travels along: all ranks stop in the same iteration
    sum_in_place(comm, sums);
    if (sums.back() > 0.0) throw_stopped(comm);
    Scalars total_size;
    std::copy_n(sums.begin(), Width, total_size.begin());
    judge(state, total_size, stop);
    if (!any_active() || state.iteration == stop.max_iterations) break;
    Scalars beta, alpha, back;
    for (int lane = 0; lane < Width; ++lane) {
      const bool moves = state.active[lane] && state.energy[lane] > 0.0;
      beta[lane] = moves ? -sums[2 * Width + lane] / state.energy[lane] : 0.0;
      state.decrease[lane] = sums[Width + lane];
    }
    if (state.iteration == 0)
      std::copy(preconditioned_.begin(), preconditioned_.end(), direction_.begin());
    else
      scale_and_add<Width>(beta, preconditioned_, direction_);
    state.energy = matrix.apply(direction_.data(), image_.data());
    sum_in_place(comm, state.energy);
    for (int lane = 0; lane < Width; ++lane) {
      const bool moves = state.active[lane] && state.energy[lane] > 0.0;
      alpha[lane] = moves ? state.decrease[lane] / state.energy[lane] : 0.0;
      back[lane] = -alpha[lane];
      state.spectrum[lane].add(alpha[lane], beta[lane]);
    }
    add_scaled<Width>(alpha, direction_, solution);
    add_scaled<Width>(back, image_, rest);
    ++state.iteration;
    if (narrow(state, rest, solution, stop)) return;
  }
}

template <class Problem, int Width>
typename LaneCg<Problem, Width>::Half& LaneCg<Problem, Width>::half() {
  if (!half_) half_ = std::make_unique<Half>(hierarchy_, problem_, cycle_);
  return *half_;
}

/// Lets the lanes that are left go on in a solver half as wide; false if there are too many.
template <class Problem, int Width>
bool LaneCg<Problem, Width>::narrow(State& state, LaneArray& rest, LaneArray& solution,
                                    const LaneStop& stop) {
  if constexpr (Width == 1) {
    return false;
  } else {
    constexpr int half_width = Width / 2;
    std::array<int, half_width> left{};
    int count = 0;
    for (int lane = 0; lane < Width; ++lane) {
      if (!state.active[lane]) continue;
      if (count == half_width) return false;
      left[count++] = lane;
    }
    if (count == 0) return false;
    const std::span<const int> lanes(left.data(), count);
    half().multigrid_.template select<Width>(multigrid_, lanes);
    typename LaneCg<Problem, half_width>::State narrower;
    narrower.iteration = state.iteration;
    for (int i = 0; i < std::min(count, half_width); ++i) {
      narrower.active[i] = true;
      narrower.start[i] = state.start[lanes[i]];
      narrower.decrease[i] = state.decrease[lanes[i]];
      narrower.energy[i] = state.energy[lanes[i]];
      narrower.spectrum[i] = state.spectrum[lanes[i]];
      narrower.outcome[i] = state.outcome[lanes[i]];
    }
    LaneArray half_rest, half_solution;
    select_lanes(rest, Width, lanes, half_rest, half_width);
    select_lanes(solution, Width, lanes, half_solution, half_width);
    select_lanes(direction_, Width, lanes, half_->direction_, half_width);
    select_lanes(image_, Width, lanes, half_->image_, half_width);
    half_->iterate(narrower, half_rest, half_solution, stop);
    for (int i = 0; i < std::min(count, half_width); ++i) {
      state.outcome[lanes[i]] = narrower.outcome[i];
      for (std::size_t at = 0; at < solution.size() / Width; ++at)
        solution[at * Width + lanes[i]] = half_solution[at * half_width + i];
    }
    return true;
  }
}

}  // namespace fabseq
