// SPDX-License-Identifier: MIT
/// \file
/// Definitions of LaneCg that hand lanes to a solver half as wide, and its set-up back, for lane_cg_impl.h.
#pragma once

#include "cg/lane_cg.h"

#include <algorithm>
#include <array>
#include <memory>
#include <span>

namespace fabseq {

template <class Problem, int Width>
typename LaneCg<Problem, Width>::Half& LaneCg<Problem, Width>::half() {
  if (!half_) half_ = std::make_unique<Half>(hierarchy_, problem_, cycle_);
  return *half_;
}

/// Lane i becomes lane lanes[i] of another solver.
template <class Problem, int Width>
template <int Other>
void LaneCg<Problem, Width>::copy_set_up(LaneCg<Problem, Other>& other, std::span<const int> lanes) {
  allocate();
  multigrid_->template select<Other>(*other.multigrid_, lanes);
  matrix_->template select<Other>(*other.matrix_, lanes);
  if constexpr (Problem::own_operators)
    islands_.template select<Other>(other.islands_, lanes);
  else
    diagonal_ = other.diagonal_;
  for (int lane = 0; lane < Width; ++lane) positive_[lane] = other.positive_[selected(lanes, lane)];
}

template <class Problem, int Width>
void LaneCg<Problem, Width>::set_up_from_half(int count) {
  if constexpr (Width > 1) {
    std::array<int, Width> lanes{};
    for (int i = 0; i < 2 * count; ++i) lanes[i] = i % count;
    copy_set_up(half(), std::span<const int>(lanes.data(), 2 * count));
  }
}

/// Lets the lanes that are left go on in a solver half as wide; false if there are too many, or is none.
template <class Problem, int Width>
bool LaneCg<Problem, Width>::narrow(Progress& progress, LaneArray& residual, LaneArray& solution,
                                    const LaneStop& stop) {
  if constexpr (Width == 1) {
    return false;
  } else {
    if (!cycle_.narrows) return false;
    constexpr int half_width = Width / 2;
    std::array<int, half_width> left{};
    int count = 0;
    for (int lane = 0; lane < Width; ++lane) {
      if (!progress.active[lane]) continue;
      if (count == half_width) return false;
      left[count++] = lane;
    }
    if (count == 0) return false;
    const std::span<const int> lanes(left.data(), count);
    half().copy_set_up(*this, lanes);
    LaneProgress<half_width> narrower;
    narrower.take(progress, lanes);
    LaneArray& half_residual = half_->handed_residual_;
    LaneArray& half_solution = half_->handed_solution_;
    select_lanes(residual, Width, lanes, half_residual, half_width);
    select_lanes(rounded_residual_, Width, lanes, half_->rounded_residual_, half_width);
    select_lanes(solution, Width, lanes, half_solution, half_width);
    select_lanes(direction_, Width, lanes, half_->direction_, half_width);
    select_lanes(image_, Width, lanes, half_->image_, half_width);
    half_->iterate(narrower, half_residual, half_solution, stop);
    for (int i = 0; i < std::min(count, half_width); ++i) {
      progress.outcome[lanes[i]] = narrower.outcome[i];
      for (std::size_t at = 0; at < solution.size() / Width; ++at)
        solution[at * Width + lanes[i]] = half_solution[at * half_width + i];
    }
    return true;
  }
}

}  // namespace fabseq
