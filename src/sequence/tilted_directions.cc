// SPDX-License-Identifier: MIT
#include "fabseq/sequence/tilted_directions.h"

#include "fabseq/grid/grid.h"
#include "sequence/tilt_vectors.h"

#include <cmath>
#include <numbers>

namespace fabseq {

namespace {

constexpr double largest_step = 15.0;  // degrees

}  // namespace

template <int Dim>
std::vector<TiltedDirection<Dim>> tilted_directions(const BuildPlate& plate, double largest_tilt) {
  std::vector<TiltedDirection<Dim>> result = {{plate.normal<Dim>(), 0.0}};
  const TiltVectors<Dim> vectors(plate);
  const int steps = static_cast<int>(std::ceil(largest_tilt / largest_step));
  constexpr int sides = Dim == 2 ? 2 : 8;
  for (int step = 1; step <= steps; ++step)
    for (int side = 0; side < sides; ++side) {
      const double tilt = largest_tilt * step / steps;
      const double angle = tilt * std::numbers::pi / 180.0, around = 2.0 * std::numbers::pi * side / sides;
      const double vector[] = {angle * std::cos(around), angle * std::sin(around)};
      result.push_back({vectors.direction(vector), tilt});
    }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(tilted_directions);

}  // namespace fabseq
