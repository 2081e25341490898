// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_mesh.h"
#include "kernels/lanes.h"

#include <array>
#include <cstdint>
#include <vector>

namespace fabseq {

/// Multilinear interpolation, along runs of nodes, between a fine mesh and the coarse one it sits in: coarse
/// node I lies where fine node factor * I lies. Every coarse node that interpolates to a node of the fine
/// mesh is in the coarse mesh.
template <int Dim>
class LaneTransfer {
 public:
  LaneTransfer() = default;
  /// `factors`: 2 along coarsened axes, else 1.
  LaneTransfer(const LaneMesh<Dim>& fine, const LaneMesh<Dim>& coarse, const Index<Dim>& factors);

  /// fine += P coarse. Both [node][component][lane].
  template <int Components, int Width, class Real>
  void prolong_add(const Real* coarse, Real* fine) const;
  /// coarse += P^T fine.
  template <int Components, int Width, class Real>
  void restrict_add(const Real* fine, Real* coarse) const;

 private:
  static constexpr int max_lines = corner_count<Dim> / 2;
  /// A run of fine nodes, and the lines of coarse nodes next to it.
  struct Run {
    std::int64_t fine = 0;
    std::array<std::int64_t, max_lines> coarse{};  ///< at or below the first fine node
    int lines = 1;
    int length = 0;
    bool starts_between = false;  ///< the first node lies between two coarse nodes
  };
  template <int Components, int Width, class Real>
  using Values = std::array<Lanes<Width, Real>, Components>;

  std::vector<Run> runs_;
  bool halves_x_ = true;
};

template <int Dim>
template <int Components, int Width, class Real>
void LaneTransfer<Dim>::prolong_add(const Real* coarse, Real* fine) const {
  constexpr int node_values = Components * Width;
  for (const Run& run : runs_) {
    const Real weight = Real{1} / static_cast<Real>(run.lines);
    const auto mean = [&](std::int64_t i) {
      Values<Components, Width, Real> values;
      for (int a = 0; a < Components; ++a) {
        auto sum = Lanes<Width, Real>::load(coarse + (run.coarse[0] + i) * node_values + a * Width);
        for (int line = 1; line < run.lines; ++line)
          sum += Lanes<Width, Real>::load(coarse + (run.coarse[line] + i) * node_values + a * Width);
        values[a] = sum * weight;
      }
      return values;
    };
    Real* place = fine + run.fine * node_values;
    const auto add = [&](const Values<Components, Width, Real>& values) {
      for (int a = 0; a < Components; ++a, place += Width)
        (Lanes<Width, Real>::load(place) + values[a]).store(place);
    };
    if (!halves_x_) {
      for (int i = 0; i < run.length; ++i) add(mean(i));
      continue;
    }
    Values<Components, Width, Real> below = mean(0);
    int left = run.length;
    if (!run.starts_between) {
      add(below);
      --left;
    }
    for (int i = 1; left > 0; ++i) {
      const Values<Components, Width, Real> above = mean(i);
      Values<Components, Width, Real> between;
      for (int a = 0; a < Components; ++a) between[a] = (below[a] + above[a]) * Real{0.5};
      add(between);
      if (--left > 0) {
        add(above);
        --left;
      }
      below = above;
    }
  }
}

template <int Dim>
template <int Components, int Width, class Real>
void LaneTransfer<Dim>::restrict_add(const Real* fine, Real* coarse) const {
  constexpr int node_values = Components * Width;
  for (const Run& run : runs_) {
    const Real weight = Real{1} / static_cast<Real>(run.lines);
    const Real* place = fine + run.fine * node_values;
    const auto read = [&] {
      Values<Components, Width, Real> values;
      for (int a = 0; a < Components; ++a, place += Width) values[a] = Lanes<Width, Real>::load(place);
      return values;
    };
    const auto add = [&](std::int64_t i, const Values<Components, Width, Real>& values) {
      for (int line = 0; line < run.lines; ++line)
        for (int a = 0; a < Components; ++a) {
          Real* to = coarse + (run.coarse[line] + i) * node_values + a * Width;
          (Lanes<Width, Real>::load(to) + values[a] * weight).store(to);
        }
    };
    if (!halves_x_) {
      for (int i = 0; i < run.length; ++i) add(i, read());
      continue;
    }
    Values<Components, Width, Real> sum;
    sum.fill(Lanes<Width, Real>::zero());
    int left = run.length;
    if (!run.starts_between) {
      sum = read();
      --left;
    }
    int i = 0;
    for (; left > 0; ++i) {
      const Values<Components, Width, Real> between = read();
      for (int a = 0; a < Components; ++a) sum[a] += between[a] * Real{0.5};
      add(i, sum);
      for (int a = 0; a < Components; ++a) sum[a] = between[a] * Real{0.5};
      if (--left > 0) {
        const Values<Components, Width, Real> at = read();
        for (int a = 0; a < Components; ++a) sum[a] += at[a];
        --left;
      }
    }
    add(i, sum);
  }
}

}  // namespace fabseq
