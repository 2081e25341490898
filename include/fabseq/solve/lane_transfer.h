/// \file
/// Multilinear interpolation between two levels of lane meshes, along runs of nodes.
#pragma once

#include "fabseq/fem/lane_mesh.h"
#include "fabseq/fem/lanes.h"

#include <array>
#include <cstdint>
#include <vector>

namespace fabseq {

/// A fine mesh and the coarse one it sits in: coarse node I lies where fine node factor * I lies. Every coarse
/// node that interpolates to a node of the fine mesh is in the coarse mesh.
template <int Dim>
class LaneTransfer {
 public:
  LaneTransfer() = default;
  /// `factors`: 2 along coarsened axes, else 1.
  LaneTransfer(const LaneMesh<Dim>& fine, const LaneMesh<Dim>& coarse, const Index<Dim>& factors);

  /// fine += P coarse. Both [node][component][lane].
  template <int Components, int Width>
  void prolong_add(const double* coarse, double* fine) const;
  /// coarse += P^T fine.
  template <int Components, int Width>
  void restrict_add(const double* fine, double* coarse) const;

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
  template <int Components, int Width>
  using Values = std::array<Lanes<Width>, Components>;

  std::vector<Run> runs_;
  bool halves_x_ = true;
};

template <int Dim>
template <int Components, int Width>
void LaneTransfer<Dim>::prolong_add(const double* coarse, double* fine) const {
  constexpr int block = Components * Width;
  for (const Run& run : runs_) {
    const double weight = 1.0 / run.lines;
    const auto mean = [&](std::int64_t i) {
      Values<Components, Width> values;
      for (int a = 0; a < Components; ++a) {
        auto sum = Lanes<Width>::load(coarse + (run.coarse[0] + i) * block + a * Width);
        for (int line = 1; line < run.lines; ++line)
          sum += Lanes<Width>::load(coarse + (run.coarse[line] + i) * block + a * Width);
        values[a] = sum * weight;
      }
      return values;
    };
    double* place = fine + run.fine * block;
    const auto add = [&](const Values<Components, Width>& values) {
      for (int a = 0; a < Components; ++a, place += Width)
        (Lanes<Width>::load(place) + values[a]).store(place);
    };
    if (!halves_x_) {
      for (int i = 0; i < run.length; ++i) add(mean(i));
      continue;
    }
    Values<Components, Width> below = mean(0);
    int left = run.length;
    if (!run.starts_between) {
      add(below);
      --left;
    }
    for (int i = 1; left > 0; ++i) {
      const Values<Components, Width> above = mean(i);
      Values<Components, Width> between;
      for (int a = 0; a < Components; ++a) between[a] = (below[a] + above[a]) * 0.5;
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
template <int Components, int Width>
void LaneTransfer<Dim>::restrict_add(const double* fine, double* coarse) const {
  constexpr int block = Components * Width;
  for (const Run& run : runs_) {
    const double weight = 1.0 / run.lines;
    const double* place = fine + run.fine * block;
    const auto read = [&] {
      Values<Components, Width> values;
      for (int a = 0; a < Components; ++a, place += Width) values[a] = Lanes<Width>::load(place);
      return values;
    };
    const auto add = [&](std::int64_t i, const Values<Components, Width>& values) {
      for (int line = 0; line < run.lines; ++line)
        for (int a = 0; a < Components; ++a) {
          double* to = coarse + (run.coarse[line] + i) * block + a * Width;
          (Lanes<Width>::load(to) + values[a] * weight).store(to);
        }
    };
    if (!halves_x_) {
      for (int i = 0; i < run.length; ++i) add(i, read());
      continue;
    }
    Values<Components, Width> sum;
    sum.fill(Lanes<Width>::zero());
    int left = run.length;
    if (!run.starts_between) {
      sum = read();
      --left;
    }
    int i = 0;
    for (; left > 0; ++i) {
      const Values<Components, Width> between = read();
      for (int a = 0; a < Components; ++a) sum[a] += between[a] * 0.5;
      add(i, sum);
      for (int a = 0; a < Components; ++a) sum[a] = between[a] * 0.5;
      if (--left > 0) {
        const Values<Components, Width> at = read();
        for (int a = 0; a < Components; ++a) sum[a] += at[a];
        --left;
      }
    }
    add(i, sum);
  }
}

extern template class LaneTransfer<2>;
extern template class LaneTransfer<3>;

}  // namespace fabseq
