// SPDX-License-Identifier: MIT
#pragma once

#include "cg/lane_outcome.h"
#include "cg/spectrum_estimate.h"
#include "kernels/lane_array.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace fabseq {

/// Where the conjugate gradients of all lanes are, apart from their vectors, and which lanes go on
/// (docs/developer/lane-engine.md 11.3). The same on all ranks, but for `length`.
template <int Width>
struct LaneProgress {
  using Scalars = LaneScalars<Width>;

  int iteration = 0;
  bool guessed = false;  ///< whether the solution begins with a guess
  std::array<bool, Width> active{};
  static Scalars ones() {
    Scalars result;
    result.fill(1.0);
    return result;
  }
  Scalars known_smallest = ones();  ///< of the eigenvalues of M K, before the first step
  Scalars start{};                  ///< |M f|^2; infinite with a guess
  Scalars length{};                 ///< |u|^2, this rank's part
  Scalars decrease{};               ///< r . M r of the last step
  Scalars energy{};                 ///< p . K p of the last step
  std::array<SpectrumEstimate, Width> spectrum;
  std::array<LaneOutcome, Width> outcome{};

  bool any_active() const { return std::find(active.begin(), active.end(), true) != active.end(); }
  /// Ends lanes whose preconditioned residual is small enough, or no number. `size`: |M r|^2, `length`:
  /// |u|^2, of all ranks.
  void judge(const Scalars& size, const Scalars& length, const LaneStop& stop);
  /// Ends lanes that were within LaneStop::reach before a step of these lengths, by what the step says of the
  /// spectrum, too.
  void end_within_reach(const Scalars& alpha, const LaneStop& stop);
  /// Lane i becomes lane lanes[i] of another one, after a step.
  template <int Other>
  void take(const LaneProgress<Other>& other, std::span<const int> lanes);

 private:
  double smallest(int lane) const { return std::min(known_smallest[lane], spectrum[lane].smallest()); }
  double bound(int lane, const LaneStop& stop) const {
    return stop.tolerance_of(outcome[lane].has_islands) * std::min(1.0, stop.error_factor * smallest(lane));
  }
};

/// The residual is compared with the solution, too: where a part hangs by little, |M f| is not |u| but what
/// rounding f does to it.
template <int Width>
void LaneProgress<Width>::judge(const Scalars& size, const Scalars& length_of_all, const LaneStop& stop) {
  for (int lane = 0; lane < Width; ++lane) {
    if (!active[lane]) continue;
    // At the start there is nothing but the rigid motions of islands, which are part of M f.
    const bool has_guess = guessed && length_of_all[lane] > 0.0;
    if (iteration == 0)
      start[lane] = has_guess ? std::numeric_limits<double>::infinity() : size[lane] + length_of_all[lane];
    const bool compares_start = iteration == 0 && !has_guess;
    const double reference = compares_start ? start[lane] : std::min(start[lane], length_of_all[lane]);
    LaneOutcome& of_lane = outcome[lane];
    of_lane.iterations = iteration;
    of_lane.finite = std::isfinite(size[lane]);
    of_lane.residual = size[lane] == 0.0 ? 0.0 : std::sqrt(size[lane] / reference);
    of_lane.smallest = smallest(lane);
    of_lane.converged = of_lane.finite && of_lane.residual <= bound(lane, stop);
    if (of_lane.converged || !of_lane.finite) active[lane] = false;
  }
}

template <int Width>
void LaneProgress<Width>::end_within_reach(const Scalars& alpha, const LaneStop& stop) {
  if (stop.reach <= 1.0) return;
  for (int lane = 0; lane < Width; ++lane) {
    const bool moved = std::isfinite(alpha[lane]) && alpha[lane] != 0.0;
    if (!active[lane] || !moved || outcome[lane].residual > stop.reach * bound(lane, stop)) continue;
    outcome[lane].iterations = iteration;
    outcome[lane].converged = true;
    outcome[lane].smallest = smallest(lane);
    active[lane] = false;
  }
}

template <int Width>
template <int Other>
void LaneProgress<Width>::take(const LaneProgress<Other>& other, std::span<const int> lanes) {
  iteration = other.iteration;
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const int from = lanes[i];
    active[i] = true;
    known_smallest[i] = other.known_smallest[from];
    start[i] = other.start[from];
    length[i] = other.length[from];
    decrease[i] = other.decrease[from];
    energy[i] = other.energy[from];
    spectrum[i] = other.spectrum[from];
    outcome[i] = other.outcome[from];
  }
}

}  // namespace fabseq
