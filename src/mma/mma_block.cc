// SPDX-License-Identifier: MIT
#include "mma/mma_variables.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

// Tolerance of a variable's own equation, in v. Steps converge quadratically: after one as small as this the
// next would be lost in rounding.
constexpr double step_tolerance = 1e-8;
constexpr int step_iterations = 60;

// One step of all variables to their minimizer: what is left after taking away the barrier of the nearer
// bound is taken as linear, and the quadratic equation for the distance from this bound solved. Returns the
// largest step.
double MmaBlock::approach(double barrier) {
  Array step{};
  for (std::size_t k = 0; k < count; ++k) {
    const double per_above = 1.0 / (upper[k] - v[k]), per_below = 1.0 / (lower[k] + v[k]);
    const double above = upper[k] * per_above, below = lower[k] * per_below;
    const double up = (1.0 + ratio[k]) * above * above, down = (1.0 - ratio[k]) * below * below;
    const double from_alpha = v[k] - alpha[k], from_beta = beta[k] - v[k];
    const bool at_alpha = from_alpha < from_beta;
    const double near = at_alpha ? from_alpha : from_beta, far = at_alpha ? from_beta : from_alpha;
    const double per_far = 1.0 / far, pull = barrier * per_far;
    const double value = (at_alpha ? up - down : down - up) + pull;
    const double slope = 2.0 * (up * per_above + down * per_below) + pull * per_far;
    const double linear = value - slope * near;
    const double root = std::sqrt(linear * linear + 4.0 * slope * barrier) + std::abs(linear);
    const double wanted = (linear > 0.0 ? 2.0 * barrier : root) / (linear > 0.0 ? root : 2.0 * slope);
    const double distance = std::min(wanted, near + 0.9 * far);
    const double next = at_alpha ? alpha[k] + distance : beta[k] - distance;
    step[k] = std::abs(next - v[k]);
    v[k] = next;
  }
  return *std::max_element(step.begin(), step.end());
}

void MmaBlock::minimize(double barrier) {
  for (int i = 0; i < step_iterations; ++i) {
    if (!(approach(barrier) > step_tolerance)) return;
  }
}

void MmaBlock::expand(double barrier) {
  for (std::size_t k = 0; k < count; ++k) {
    const double per_above = 1.0 / (upper[k] - v[k]), per_below = 1.0 / (lower[k] + v[k]);
    const double above = upper[k] * per_above, below = lower[k] * per_below;
    const double a = v[k] * above, da = above * above;
    const double b = v[k] * below, db = below * below;
    const double up = 1.0 / (v[k] - alpha[k]), down = 1.0 / (beta[k] - v[k]);
    const double diagonal = 2.0 * ((1.0 + ratio[k]) * da * per_above + (1.0 - ratio[k]) * db * per_below) +
                            barrier * (up * up + down * down);
    const double root = std::sqrt(width[k] / (curved[k] * diagonal));
    const double slope = da - db - barrier * (up - down);
    even_slope[k] = 0.5 * (da + db) * root;
    bulge_slope[k] = mma_bulge_factor * slope * root;
    curvature_slope[k] = curvature[k] * slope * root;
    kappa[k] = (up - down) * root * curved[k];
    even[k] = 0.5 * (a + b) * width[k];
    bulge[k] = mma_bulge_factor * (a - b) * width[k];
  }
  curvature_change = curvature_wall = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double log_wall = -std::log(4.0 * (v[k] - alpha[k]) * (beta[k] - v[k])) * width[k];
    wall[k] = mma_bulge_factor * log_wall;
    bulge[k] += barrier * wall[k];
    curvature_change += curvature[k] * bulge[k] / mma_bulge_factor;
    curvature_wall += curvature[k] * log_wall;
  }
}

}  // namespace fabseq
