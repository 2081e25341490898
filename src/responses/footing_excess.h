// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/footing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace fabseq {

/// Amount by which an element beside another one misses its footing, smoothly (docs/formulation.md 13.2): no
/// excess is positive only if the exact check finds it there, too.
template <int Dim>
class FootingExcess {
 public:
  static constexpr int count = 3;

  /// `step`: to the other element.
  FootingExcess(const Footing<Dim>& footing, const Index<Dim>& step) : footing_(footing) {
    least_edge_ = *std::min_element(footing.spacing.begin(), footing.spacing.end());
    for (int i = 0; i < Dim; ++i) {
      offset_[i] = step[i] * footing.spacing[i];
      next_ = next_ && std::abs(step[i]) <= 1;
    }
  }

  /// How far an element reaches along a build direction, smoothly, length unit.
  struct Extent {
    double largest = 0.0, least = 0.0;
  };
  static Extent extent(const Footing<Dim>& footing, const Point<Dim>& axis) {
    Extent result;
    for (int i = 0; i < Dim; ++i) {
      const double root = std::sqrt(axis[i] * axis[i] + rounded_edge * rounded_edge);
      result.largest += root * footing.spacing[i];
      result.least += (root - rounded_edge) * footing.spacing[i];
    }
    return result;
  }

  /// Too high, too low, too far to the side; in units of the shortest edge. `axis`: the build direction, no
  /// longer than 1.
  std::array<double, count> values(const Point<Dim>& axis, const Extent& extent) const {
    const double along = -dot(offset_, axis), radius = footing_.radius;
    return {(0.5 * extent.largest - along) / least_edge_,
            next_ ? -std::numeric_limits<double>::infinity() : (along - extent.least) / least_edge_,
            (dot(offset_, offset_) - along * along - radius * radius) / (2.0 * radius * least_edge_)};
  }

  /// Adds the derivative of the weighted excesses with respect to the axis.
  void add_derivative(const Point<Dim>& axis, const std::array<double, count>& weights,
                      Point<Dim>& d_axis) const {
    const double along = -dot(offset_, axis);
    for (int i = 0; i < Dim; ++i) {
      const double d_extent =
          footing_.spacing[i] * axis[i] / std::sqrt(axis[i] * axis[i] + rounded_edge * rounded_edge);
      d_axis[i] += (weights[0] * (0.5 * d_extent + offset_[i]) + weights[1] * (-offset_[i] - d_extent) +
                    weights[2] * along * offset_[i] / footing_.radius) /
                   least_edge_;
    }
  }

 private:
  /// The extent of an element has edges where a component of the axis changes its sign. Rounded off, it is
  /// never smaller, and less this number never larger.
  static constexpr double rounded_edge = 0.05;

  const Footing<Dim>& footing_;
  Point<Dim> offset_;  ///< length unit
  double least_edge_;
  bool next_ = true;  ///< it shares a corner, so that it is never too low
};

}  // namespace fabseq
