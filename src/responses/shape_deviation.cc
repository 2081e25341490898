// SPDX-License-Identifier: MIT
#include "fabseq/responses/shape_deviation.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/grid/rigid_fit.h"

#include <cmath>
#include <functional>
#include <numeric>

namespace fabseq {

namespace {

/// A motion of a set's nodes, or their displacement: [owned node of the set][component].
using Motion = std::vector<double>;

/// A motion that the others nearly contain is not determined by the nodes.
constexpr double dependent = 1e-9;

template <int Dim>
class ShapeDeviation : public Response<Dim> {
 public:
  ShapeDeviation(const SetDisplacement<Dim>& set, const ShapeFit& fit) : set_(set) {
    const Point<Dim> center = this->center();
    const int rigid = fit.rotation ? rigid_motion_count<Dim> : Dim;
    for (int k = 0; k < rigid; ++k)
      add_motion([&](int axis, const Point<Dim>& x) { return rigid_motion<Dim>(k, axis, x); }, center);
    if (fit.scale) add_motion([](int axis, const Point<Dim>& x) { return x[axis]; }, center);
  }

  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    const Motion left = deviation(state);
    const double square = std::inner_product(left.begin(), left.end(), left.begin(), 0.0);
    return {sum(set_.comm(), square) / static_cast<double>(set_.nodes().count)};
  }

  /// What the fit takes out is orthogonal to what it leaves: it does not enter the derivative.
  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    const Motion left = deviation(state);
    const double factor = 2.0 * weight / static_cast<double>(set_.nodes().count);
    set_.prepare(state, adjoint);
    const std::vector<int>& nodes = set_.nodes().owned;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (int axis = 0; axis < Dim; ++axis)
        set_.add_derivative(nodes[i], axis, factor * left[i * Dim + axis], state, adjoint);
  }

 private:
  Point<Dim> center() const {
    std::vector<double> total(Dim, 0.0);
    for (const int node : set_.nodes().owned)
      for (int axis = 0; axis < Dim; ++axis) total[axis] += set_.position(node)[axis];
    sum_in_place(set_.comm(), total);
    Point<Dim> result;
    for (int axis = 0; axis < Dim; ++axis)
      result[axis] = total[axis] / static_cast<double>(set_.nodes().count);
    return result;
  }

  double dot(const Motion& a, const Motion& b) const {
    return sum(set_.comm(), std::inner_product(a.begin(), a.end(), b.begin(), 0.0));
  }

  /// Takes from a motion what it has in common with the fit's.
  void remove_fit(Motion& motion) const {
    std::vector<double> shares;
    for (const Motion& other : motions_)
      shares.push_back(std::inner_product(other.begin(), other.end(), motion.begin(), 0.0));
    sum_in_place(set_.comm(), shares);
    for (std::size_t k = 0; k < shares.size(); ++k)
      for (std::size_t i = 0; i < motion.size(); ++i) motion[i] -= shares[k] * motions_[k][i];
  }

  /// Adds a motion, given by its components at places seen from the centre, orthonormal to those before.
  void add_motion(const std::function<double(int, const Point<Dim>&)>& component, const Point<Dim>& center) {
    Motion motion;
    for (const int node : set_.nodes().owned) {
      Point<Dim> place = set_.position(node);
      for (int axis = 0; axis < Dim; ++axis) place[axis] -= center[axis];
      for (int axis = 0; axis < Dim; ++axis) motion.push_back(component(axis, place));
    }
    const double before = std::sqrt(dot(motion, motion));
    remove_fit(motion);
    remove_fit(motion);  // again, for rounding
    const double norm = std::sqrt(dot(motion, motion));
    if (norm <= dependent * before || before <= dependent * extent(center))
      throw InputError(
          "/node_sets/" + set_.nodes().name + ": its " + std::to_string(set_.nodes().count) +
          " nodes do not determine the fit of measure shape; allowed: nodes that no motion of the "
          "fit leaves in place, or fewer entries in fit");
    for (double& value : motion) value /= norm;
    motions_.push_back(std::move(motion));
  }

  /// Distance of the box's far corner from the centre: what lengths are compared with.
  double extent(const Point<Dim>& center) const {
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += center[axis] * center[axis];
    return std::sqrt(square);
  }

  Motion deviation(const PipelineState<Dim>& state) const {
    Motion result;
    for (const int node : set_.nodes().owned)
      for (int axis = 0; axis < Dim; ++axis) result.push_back(set_.at(state, node, axis));
    remove_fit(result);
    return result;
  }

  SetDisplacement<Dim> set_;
  std::vector<Motion> motions_;  ///< of the fit, orthonormal over the set's nodes of all ranks
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_shape_deviation(const SetDisplacement<Dim>& set, const ShapeFit& fit) {
  return std::make_unique<ShapeDeviation<Dim>>(set, fit);
}

FABSEQ_INSTANTIATE_FUNCTION(make_shape_deviation);

}  // namespace fabseq
