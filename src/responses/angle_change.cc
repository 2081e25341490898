// SPDX-License-Identifier: MIT
/// Distortion measure `angle`.
#include "fabseq/base/blas.h"
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "responses/distortion_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace fabseq {

namespace {

/// Planes at a smaller angle, in radians, are parallel: their angle differs from 0 by rounding.
constexpr double parallel_angle = 1e-6;
/// Nodes that scatter across a plane by more than a fifth of their least extent along it, and by more than
/// half an element's diagonal, as stairs of elements do not, are no face. The first is a ratio of variances.
constexpr double most_across = 0.05, most_diagonals = 0.5;
constexpr double degrees = 180.0 / std::numbers::pi;
/// The two smallest variances of a set must differ by more than this share of the largest one.
constexpr double least_difference = 1e-9;

/// The least-squares plane of a node set (in 2D the line), and how it tilts with displacements, to first
/// order: its normal n becomes n - sum_t t s_t, with s_t the slope of u . n along the plane's tangent t, from
/// a least-squares fit over the set (docs/formulation.md 5).
template <int Dim>
class FittedPlane {
 public:
  /// Collective on the grid's communicator. Throws InputError naming the node set if it determines no plane.
  explicit FittedPlane(const SetDisplacement<Dim>& set) : set_(set) {
    const SetExtent<Dim> extent(set);
    const auto [variance, direction] = principal_axes(extent);
    const double across = extent.radius * std::sqrt(std::max(0.0, variance[0]));
    const bool is_flat =
        variance[0] <= most_across * variance[1] || across <= most_diagonals * set.element_diagonal();
    if (!is_flat || variance[1] - variance[0] <= least_difference * variance.back())
      throw InputError("/node_sets/" + set.nodes().name + ": its " + std::to_string(set.nodes().count) +
                       " nodes determine no " + (Dim == 2 ? "line" : "plane") +
                       " for measure angle; allowed: nodes of " + (Dim == 2 ? "an edge" : "a face"));
    normal_ = direction[0];
    for (int t = 0; t < tangents; ++t) {
      tangent_[t] = direction[t + 1];
      // The coordinates along the axes are not correlated, so that each slope is a fit of its own.
      const double scale = 1.0 / (static_cast<double>(set.nodes().count) * variance[t + 1] * extent.radius);
      for (const int node : set.nodes().owned)
        slope_[t].push_back(scale * dot(tangent_[t], extent.relative(set.position(node))));
    }
  }

  /// Returns the normal of the undeformed nodes, of length 1.
  const Point<Dim>& normal() const { return normal_; }
  /// Sets the normal to another vector of length 1 that differs from it by rounding, or by its sign.
  void set_normal(const Point<Dim>& normal) { normal_ = normal; }

  /// The normal of the displaced nodes; not of length 1. Collective.
  Point<Dim> tilted(const StageResults<Dim>& state) const {
    const std::vector<int>& nodes = set_.nodes().owned;
    std::array<double, tangents> slopes{};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      double along_normal = 0.0;
      for (int axis = 0; axis < Dim; ++axis) along_normal += normal_[axis] * set_.at(state, nodes[i], axis);
      for (int t = 0; t < tangents; ++t) slopes[t] += slope_[t][i] * along_normal;
    }
    sum_in_place(set_.comm(), slopes);
    Point<Dim> result = normal_;
    for (int t = 0; t < tangents; ++t)
      for (int axis = 0; axis < Dim; ++axis) result[axis] -= slopes[t] * tangent_[t][axis];
    return result;
  }
  /// Adds the derivative of `gradient` . tilted(). Local, on all ranks.
  void add_derivative(const Point<Dim>& gradient, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const {
    const std::vector<int>& nodes = set_.nodes().owned;
    set_.prepare(state, adjoint);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (int t = 0; t < tangents; ++t)
        for (int axis = 0; axis < Dim; ++axis)
          set_.add_derivative(nodes[i], axis, -dot(gradient, tangent_[t]) * slope_[t][i] * normal_[axis],
                              state, adjoint);
  }

 private:
  static constexpr int tangents = Dim - 1;

  /// Eigenvectors, of length 1, of the covariance of the set's nodes, by ascending eigenvalue; places are
  /// relative to the set's extent.
  struct PrincipalAxes {
    std::array<double, Dim> variance{};
    std::array<Point<Dim>, Dim> direction{};
  };
  PrincipalAxes principal_axes(const SetExtent<Dim>& extent) const {
    std::vector<double> covariance(static_cast<std::size_t>(Dim) * Dim, 0.0);
    for (const int node : set_.nodes().owned) {
      const Point<Dim> x = extent.relative(set_.position(node));
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) covariance[a * Dim + b] += x[a] * x[b];
    }
    sum_in_place(set_.comm(), covariance);
    PrincipalAxes result;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b)
        result.direction[a][b] = covariance[a * Dim + b] / static_cast<double>(set_.nodes().count);
    const int size = Dim, work_size = 8 * Dim;
    std::array<double, 8 * Dim> work;
    int info = 0;
    // Replaces the matrix by the eigenvectors, its columns.
    dsyev_("V", "L", &size, result.direction.front().data(), &size, result.variance.data(), work.data(),
           &work_size, &info);
    if (info != 0) throw NumericalError("dsyev failed for a covariance: " + std::to_string(info));
    return result;
  }

  SetDisplacement<Dim> set_;
  Point<Dim> normal_{};
  std::array<Point<Dim>, tangents> tangent_{};
  /// The products of these with u . n are its slopes along the tangents, 1/length.
  std::array<SetFunction, tangents> slope_;
};

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
  double size() const override { return std::pow(0.01 * degrees, 2); }  // of a strain of 1 %

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const double change = degrees * (pair_at(state).angle - start_);
    return {change * change};
  }

  /// d(angle) = -(b . da + a . db) / sine with da across a and db across b. The quotient of change and sine
  /// is 1 in the limit of planes that start parallel and stay so.
  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const Pair<Dim> pair = pair_at(state);
    const double quotient = pair.sine > 0.0 ? (pair.angle - start_) / pair.sine : 0.0;
    const double factor = -2.0 * weight * degrees * degrees * quotient;
    plane_.add_derivative(scaled(pair.b_across_a, factor / pair.length_a), state, adjoint);
    to_.add_derivative(scaled(pair.a_across_b, factor / pair.length_b), state, adjoint);
  }

 private:
  double undeformed_angle() const { return Pair<Dim>(plane_.normal(), to_.normal()).angle; }
  Pair<Dim> pair_at(const StageResults<Dim>& state) const {
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
