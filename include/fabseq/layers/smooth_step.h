// SPDX-License-Identifier: MIT
/// \file
/// The smooth steps of curved and of multi-planar layers (docs/formulation.md 3.1, 3.2).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace fabseq {

/// exp(-x) for x >= 0, to a few units in the last place; results below 1e-307 stay there. Unlike std::exp a
/// loop over many values becomes vector instructions.
inline double exp_of_minus(double x) {
  constexpr double log2_e = 1.4426950408889634, largest = 707.0;
  constexpr double ln_2_head = 0.6931471803691238, ln_2_tail = 1.9082149292705877e-10;
  constexpr double shifter = 6755399441055744.0;  // 1.5 * 2^52: leaves the nearest integer in the low bits
  const double bounded = largest < x ? largest : x;
  const double shifted = bounded * log2_e + shifter;
  const double power = shifted - shifter;
  const double rest = (power * ln_2_head - bounded) + power * ln_2_tail;  // |rest| <= ln 2 / 2
  double series = 1.0;
  for (int k = 13; k > 0; --k) series = 1.0 + series * rest * (1.0 / k);
  const std::uint64_t exponent = (1023 - std::bit_cast<std::uint64_t>(shifted)) << 52;
  return series * std::bit_cast<double>(exponent);
}

/// Step down from 1 before time point T to 0 after it, exactly 1 up to t = 0 and 0 from t = 1 on:
/// 1 - (tanh(beta T) + tanh(beta (t - T))) / (tanh(beta T) + tanh(beta (1 - T))) in between. Beyond both ends
/// that would leave [0, 1]: such times belong to the first and to the last layer alone.
class SmoothStep {
 public:
  SmoothStep(double time_point, double beta)
      : time_point_(time_point),
        beta_(beta),
        start_(std::tanh(beta * time_point)),
        end_(std::tanh(beta * (1.0 - time_point))),
        scale_(1.0 / (start_ + end_)) {}

  double value(double time) const {
    const double x = beta_ * (std::min(std::max(time, 0.0), 1.0) - time_point_);
    const double decay = exp_of_minus(2.0 * std::abs(x));
    return 1.0 - (start_ + std::copysign((1.0 - decay) / (1.0 + decay), x)) * scale_;
  }
  /// Derivative with respect to the time: 0 beyond both ends, and at them that of the inner side.
  double derivative(double time) const { return time < 0.0 || time > 1.0 ? 0.0 : slope(time); }
  /// Returns the derivative with respect to the time point. With s, h, e the squared hyperbolic secants at
  /// the start, the time and the end: beta scale (h - s + (1 - value) (s - e)).
  double time_point_derivative(double time) const {
    const double at_start = 1.0 - start_ * start_, at_end = 1.0 - end_ * end_;
    return -slope(std::min(std::max(time, 0.0), 1.0)) +
           beta_ * scale_ * ((1.0 - value(time)) * (at_start - at_end) - at_start);
  }

 private:
  double slope(double time) const {
    const double decay = exp_of_minus(2.0 * std::abs(beta_ * (time - time_point_)));
    return -4.0 * beta_ * scale_ * decay / ((1.0 + decay) * (1.0 + decay));
  }

  double time_point_, beta_, start_, end_, scale_;
};

/// 1 / (1 + exp(-x)) and its derivative. A loop over many values becomes vector instructions.
struct Logistic {
  /// Magnitude of a negative x from which on value() is 0: the smallest numbers a processor has are slow.
  static constexpr double negligible = 690.0;

  static double value(double x) {
    const double decay = exp_of_minus(std::abs(x));
    const double value = (x < 0.0 ? decay : 1.0) / (1.0 + decay);
    return x < -negligible ? 0.0 : value;
  }
  static double derivative(double x) {
    const double decay = exp_of_minus(std::abs(x));
    const double value = decay / ((1.0 + decay) * (1.0 + decay));
    return std::abs(x) > negligible ? 0.0 : value;
  }
};

/// logistic(sharpness (1 - x^2)), x = (2 / w) (height - (j - 1/2) w): 1 inside slab j, 1/2 on its faces.
class SlabStep {
 public:
  SlabStep(int slab, double thickness, double sharpness)
      : center_((slab - 0.5) * thickness), scale_(2.0 / thickness), sharpness_(sharpness) {}

  double value(double height) const {
    const double x = scale_ * (height - center_);
    return Logistic::value(sharpness_ * (1.0 - x * x));
  }
  /// Returns the derivative with respect to the height.
  double derivative(double height) const {
    const double x = scale_ * (height - center_);
    return -2.0 * sharpness_ * scale_ * x * Logistic::derivative(sharpness_ * (1.0 - x * x));
  }
  /// Slabs farther from a height than this, in their number, are 0 there.
  static double reach(double sharpness) { return 0.5 * std::sqrt(1.0 + Logistic::negligible / sharpness); }

 private:
  double center_, scale_, sharpness_;
};

}  // namespace fabseq
