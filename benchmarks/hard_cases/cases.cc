// SPDX-License-Identifier: MIT
#include "hard_cases/cases.h"

#include <algorithm>
#include <cmath>

namespace benchmarks {

using fabseq::Index;
using fabseq::Point;

namespace {

double distance(const Point<3>& a, const Point<3>& b) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  return std::sqrt(sum);
}

/// A V-shape whose front runs ahead and stays behind: pieces that stand free until it closes.
DrawnPart wavy_front() {
  DrawnPart part = graded_v_shape();
  part.time = [](const Point<3>& at, const Index<3>&) {
    const double wave = std::sin(9.0 * at[0]) * std::sin(7.0 * at[2]) * std::sin(5.0 * at[1]);
    return std::min(0.999, distance(at, {}) / 3.0 * (1.0 + 0.1 * wave));
  };
  return part;
}

/// A ball in the air above a growing block is built early.
DrawnPart isolated_minimum() {
  DrawnPart part;
  part.contains = [](const Point<3>&, const Index<3>&) { return true; };
  part.time = [](const Point<3>& at, const Index<3>&) {
    const double ball = std::max(0.0, distance(at, {1.0, 0.5, 1.4}) - 0.35);
    return std::min(0.999, 0.05 + std::min(at[2] / 2.0, ball / 1.2));
  };
  return part;
}

/// A block on a column of `width` elements.
DrawnPart block_on_column(const Index<3>& elements, int width) {
  DrawnPart part = graded_v_shape();
  part.contains = [=](const Point<3>& at, const Index<3>& index) {
    const auto in_column = [&](int axis) {
      const int offset = index[axis] - elements[axis] / 2;
      return offset >= -(width / 2) && offset < width - width / 2;
    };
    return at[2] < 0.1 || at[2] > 1.0 || (in_column(0) && in_column(1));
  };
  return part;
}

/// Sheets one element thick are built long before what is between them.
DrawnPart stiff_sheets() {
  DrawnPart part;
  part.contains = [](const Point<3>&, const Index<3>&) { return true; };
  part.time = [](const Point<3>& at, const Index<3>& index) {
    const double time = 0.35 * at[2] + 0.15 * at[0];
    return index[0] % 16 == 8 || index[2] % 16 == 9 ? 0.3 * time : time;
  };
  return part;
}

/// Walls one element thick on a slab.
DrawnPart thin_walls(const Index<3>& elements) {
  DrawnPart part = graded_v_shape();
  part.contains = [middle = elements[1] / 2](const Point<3>& at, const Index<3>& index) {
    return at[2] < 0.1 || index[0] % 10 == 5 || index[1] == middle;
  };
  return part;
}

/// A lattice of columns and beams two elements thick that fills 2 % of the box.
DrawnPart lattice() {
  DrawnPart part = graded_v_shape();
  part.contains = [](const Point<3>&, const Index<3>& index) {
    const auto on = [](int i, int period) {
      return i % period == period / 2 || i % period == period / 2 - 1;
    };
    const bool x = on(index[0], 40), y = on(index[1], 20), z = on(index[2], 40);
    return (x && y) || (x && z) || (y && z);
  };
  return part;
}

/// Nothing becomes part between a tenth and nine tenths of the time: empty layers.
DrawnPart empty_layers() {
  DrawnPart part = graded_v_shape();
  part.sharpness = 500.0;
  part.time = [](const Point<3>& at, const Index<3>&) {
    return at[2] < 1.0 ? 0.1 * at[2] : 0.8 + 0.1 * at[2];
  };
  return part;
}

Index<3> scaled(Index<3> elements, double scale) {
  for (int& count : elements) count = std::max(2, static_cast<int>(std::lround(count * scale)));
  return elements;
}

DrawnPart with(DrawnPart part, auto&& change) {
  change(part);
  return part;
}

}  // namespace

std::vector<HardCase> hard_cases(double scale) {
  const DrawnPart v = graded_v_shape();
  std::vector<HardCase> cases{
      {"normal", "V-shape, tilted planes, N = 25, beta = 4N", v},
      {"quiet", "the same in quiet void", with(v, [](DrawnPart& p) { p.quiet_void = true; })},
      {"sharp", "beta = 500", with(v, [](DrawnPart& p) { p.sharpness = 500.0; })},
      {"nu_0.45", "Poisson's ratio 0.45", with(v, [](DrawnPart& p) { p.poisson = 0.45; })},
      {"layers_100", "N = 100, beta = 500",
       with(v, [](DrawnPart& p) { p.layer_count = 100, p.sharpness = 500.0; })},
      {"empty_layers", "layers with nothing in them", empty_layers()},
      {"flat_1_8", "elements 8 times wider than high",
       with(v,
            [](DrawnPart& p) {
              p.elements = {40, 20, 320};
              p.size = {8.0, 4.0, 8.0};
              p.contains = [](const Point<3>& at, const Index<3>&) {
                return (at[2] < 2.4 || at[0] > 4.8) && at[2] > at[0] - 4.0;
              };
              p.time = [](const Point<3>& at, const Index<3>&) {
                return (0.35 * at[2] + 0.15 * at[0]) / 4.0;
              };
            })},
      {"tall_1_8", "elements 8 times higher than wide",
       with(v,
            [](DrawnPart& p) {
              p.elements = {160, 80, 20};
            })},
      {"wavy", "a wavy front, beta = 4N", wavy_front()},
      {"wavy_sharp", "the same, beta = 13.5N", with(wavy_front(), [](DrawnPart& p) { p.sharpness = 337.5; })},
      {"minimum", "an isolated minimum of the time", isolated_minimum()},
      {"column_2", "a block on a column of 2 x 2 elements", block_on_column(scaled(v.elements, scale), 2)},
      {"column_1", "a block on a column of one element", block_on_column(scaled(v.elements, scale), 1)},
      {"sheets", "stiff sheets one element thick", stiff_sheets()},
      {"lattice", "columns and beams 2 elements thick, fill 2 %", lattice()},
      {"walls", "walls one element thick", thin_walls(scaled(v.elements, scale))}};
  for (HardCase& hard : cases) hard.part.elements = scaled(hard.part.elements, scale);
  return cases;
}

}  // namespace benchmarks
