// SPDX-License-Identifier: MIT
/// Distortion measure `flatness`.
#include "fabseq/base/mpi.h"
#include "responses/distortion_functionals.h"
#include "responses/distortion_measures.h"

namespace fabseq {

namespace {

template <int Dim>
class Flatness : public Response<Dim> {
 public:
  Flatness(const SetDisplacement<Dim>& set, const DistortionSettings& settings)
      : set_(set), settings_(settings), axis_(settings.axis) {}

  bool uses_displacements() const override { return true; }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const double average = mean(state);
    double square = 0.0;
    for (const int node : set_.nodes().owned) {
      const double deviation = set_.at(state, node, axis_) - average;
      square += deviation * deviation;
    }
    return {sum(set_.comm(), square) / static_cast<double>(set_.nodes().count)};
  }

  /// The derivative of the mean drops out because the deviations sum to zero.
  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const double average = mean(state);
    set_.prepare(state, adjoint);
    for (const int node : set_.nodes().owned) {
      const double deviation = set_.at(state, node, axis_) - average;
      set_.add_derivative(node, axis_, 2.0 * weight / static_cast<double>(set_.nodes().count) * deviation,
                          state, adjoint);
    }
  }

  std::optional<SumOfSquares<Dim>> squares(TermScaling scaling) const override {
    if (!settings_.offers_squares(scaling)) return std::nullopt;
    return sum_of_squares(set_, linear_modes(set_, {axis_}, false),
                          1.0 / static_cast<double>(set_.nodes().count), settings_.least_squares.has_value());
  }

 private:
  double mean(const StageResults<Dim>& state) const {
    double total = 0.0;
    for (const int node : set_.nodes().owned) total += set_.at(state, node, axis_);
    return sum(set_.comm(), total) / static_cast<double>(set_.nodes().count);
  }

  SetDisplacement<Dim> set_;
  DistortionSettings settings_;
  int axis_;
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_flatness(const SetDisplacement<Dim>& set,
                                             const DistortionSettings& settings) {
  return std::make_unique<Flatness<Dim>>(set, settings);
}

FABSEQ_INSTANTIATE_FUNCTION(make_flatness);

}  // namespace fabseq
