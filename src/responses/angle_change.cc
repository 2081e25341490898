// SPDX-License-Identifier: MIT
/// Distortion measure `angle`.
#include "fabseq/responses/distortion_measures.h"
#include "fabseq/responses/fitted_plane.h"

#include <cmath>
#include <numbers>

namespace fabseq {

namespace {

/// Planes at a smaller angle, in radians, are parallel: their angle differs from 0 by rounding.
constexpr double parallel_angle = 1e-6;
constexpr double degrees = 180.0 / std::numbers::pi;

/// Two vectors of length 1 and the angle between them.
template <int Dim>
struct Pair {
  Point<Dim> a, b;
  Point<Dim> b_across_a{}, a_across_b{};  ///< of each the part across the other
  double length_a = 1.0, length_b = 1.0;  ///< before they were normalized
  double sine = 0.0, angle = 0.0;         ///< angle from 0 to pi

  Pair(const Point<Dim>& first, const Point<Dim>& second) : a(first), b(second) {
    length_a = normalize(a);
    length_b = normalize(b);
    double cosine = 0.0;
    for (int axis = 0; axis < Dim; ++axis) cosine += a[axis] * b[axis];
    for (int axis = 0; axis < Dim; ++axis) {
      b_across_a[axis] = b[axis] - cosine * a[axis];
      a_across_b[axis] = a[axis] - cosine * b[axis];
    }
    Point<Dim> across = b_across_a;
    sine = normalize(across);
    angle = std::atan2(sine, cosine);
  }

 private:
  /// Returns the length that the vector had.
  static double normalize(Point<Dim>& vector) {
    double square = 0.0;
    for (const double component : vector) square += component * component;
    const double length = std::sqrt(square);
    if (length > 0.0)
      for (double& component : vector) component /= length;
    return length;
  }
};

/// Both perpendicular and parallel planes have derivatives: where the planes are parallel, the measure is the
/// square of the tilt between them, whatever its direction.
template <int Dim>
class AngleChange : public Response<Dim> {
 public:
  AngleChange(const SetDisplacement<Dim>& nodes, const SetDisplacement<Dim>& to) : plane_(nodes), to_(to) {
    if (undeformed_angle() > std::numbers::pi / 2.0) to_.set_normal(scaled(to_.normal(), -1.0));
    if (undeformed_angle() < parallel_angle) to_.set_normal(plane_.normal());
    start_ = undeformed_angle();
  }

  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    const double change = degrees * (pair_at(state).angle - start_);
    return {change * change};
  }

  /// d(angle) = -(b . da + a . db) / sine with da across a and db across b. The quotient of change and sine
  /// is 1 in the limit of planes that start parallel and stay so.
  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    const Pair<Dim> pair = pair_at(state);
    const double quotient = pair.sine > 0.0 ? (pair.angle - start_) / pair.sine : 0.0;
    const double factor = -2.0 * weight * degrees * degrees * quotient;
    plane_.add_derivative(scaled(pair.b_across_a, factor / pair.length_a), state, adjoint);
    to_.add_derivative(scaled(pair.a_across_b, factor / pair.length_b), state, adjoint);
  }

 private:
  double undeformed_angle() const { return Pair<Dim>(plane_.normal(), to_.normal()).angle; }
  Pair<Dim> pair_at(const PipelineState<Dim>& state) const {
    return Pair<Dim>(plane_.tilted(state), to_.tilted(state));
  }
  static Point<Dim> scaled(Point<Dim> vector, double factor) {
    for (double& component : vector) component *= factor;
    return vector;
  }

  FittedPlane<Dim> plane_, to_;
  double start_ = 0.0;  ///< angle between the undeformed planes, radians, at most a right one
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_angle_change(const SetDisplacement<Dim>& nodes,
                                                 const SetDisplacement<Dim>& to) {
  return std::make_unique<AngleChange<Dim>>(nodes, to);
}

FABSEQ_INSTANTIATE_FUNCTION(make_angle_change);

}  // namespace fabseq
