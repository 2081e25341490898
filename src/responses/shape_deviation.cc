// SPDX-License-Identifier: MIT
/// Distortion measure `shape`.
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/grid/rigid_fit.h"
#include "responses/distortion_functionals.h"
#include "responses/distortion_measures.h"

#include <cmath>
#include <functional>
#include <numeric>

namespace fabseq {

namespace {

template <int Dim>
class ShapeDeviation : public Response<Dim> {
 public:
  ShapeDeviation(const SetDisplacement<Dim>& set, const DistortionSettings& settings)
      : set_(set), settings_(settings), extent_(set), motions_(set.comm()) {
    const int rigid = settings.fits("rotation") ? rigid_motion_count<Dim> : Dim;
    for (int k = 0; k < rigid; ++k)
      add_motion([&](int axis, const Point<Dim>& x) { return rigid_motion<Dim>(k, axis, x); });
    if (settings.fits("scale")) add_motion([](int axis, const Point<Dim>& x) { return x[axis]; });
  }

  bool uses_displacements() const override { return true; }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const SetFunction left = deviation(state);
    const double square = std::inner_product(left.begin(), left.end(), left.begin(), 0.0);
    return {sum(set_.comm(), square) / static_cast<double>(set_.nodes().count)};
  }

  /// What the fit takes out is orthogonal to what it leaves: it does not enter the derivative.
  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const double factor = 2.0 * weight / static_cast<double>(set_.nodes().count);
    set_.add_derivative(deviation(state), factor, state, adjoint);
  }

  /// The linear displacements that the fit leaves: uniform strain, as a rule.
  std::optional<SumOfSquares<Dim>> squares(TermScaling scaling) const override {
    if (!settings_.offers_squares(scaling)) return std::nullopt;
    OrthonormalFunctions linear = motions_;
    for (int component = 0; component < Dim; ++component)
      for (int along = 0; along < Dim; ++along)
        linear.add(motion([&](int axis, const Point<Dim>& x) { return axis == component ? x[along] : 0.0; }),
                   least());
    SetModes modes;
    modes.modes.assign(linear.functions().begin() + static_cast<std::ptrdiff_t>(motions_.count()),
                       linear.functions().end());
    modes.complete = static_cast<std::int64_t>(linear.count()) == Dim * set_.nodes().count;
    return sum_of_squares(set_, std::move(modes), 1.0 / static_cast<double>(set_.nodes().count),
                          settings_.least_squares.has_value());
  }

 private:
  /// A component at a place relative to the set's extent.
  using Component = std::function<double(int axis, const Point<Dim>& place)>;

  SetFunction motion(const Component& component) const {
    SetFunction result;
    for (const int node : set_.nodes().owned) {
      const Point<Dim> place = extent_.relative(set_.position(node));
      for (int axis = 0; axis < Dim; ++axis) result.push_back(component(axis, place));
    }
    return result;
  }
  /// Motions are of the order of 1 at a node.
  double least() const { return dependent_share * std::sqrt(static_cast<double>(set_.nodes().count)); }

  void add_motion(const Component& component) {
    if (motions_.add(motion(component), least())) return;
    throw InputError("/node_sets/" + set_.nodes().name + ": its " + std::to_string(set_.nodes().count) +
                     " nodes do not determine the fit of measure shape; allowed: nodes that no motion of "
                     "the fit leaves in place, or fewer entries in fit");
  }

  SetFunction deviation(const StageResults<Dim>& state) const {
    SetFunction result = set_.all(state);
    motions_.remove_from(result);
    return result;
  }

  SetDisplacement<Dim> set_;
  DistortionSettings settings_;
  SetExtent<Dim> extent_;
  OrthonormalFunctions motions_;  ///< of the fit
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_shape_deviation(const SetDisplacement<Dim>& set,
                                                    const DistortionSettings& settings) {
  return std::make_unique<ShapeDeviation<Dim>>(set, settings);
}

FABSEQ_INSTANTIATE_FUNCTION(make_shape_deviation);

}  // namespace fabseq
