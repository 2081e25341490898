// SPDX-License-Identifier: MIT
/// Distortion measure `displacement`.
#include "fabseq/base/mpi.h"
#include "responses/distortion_functionals.h"
#include "responses/distortion_measures.h"

#include <numeric>

namespace fabseq {

namespace {

template <int Dim>
class Displacement : public Response<Dim> {
 public:
  Displacement(const SetDisplacement<Dim>& set, const DistortionSettings& settings)
      : set_(set),
        settings_(settings),
        factor_(settings.mean ? 1.0 / static_cast<double>(set.nodes().count) : 1.0) {}

  bool uses_displacements() const override { return true; }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const SetFunction u = set_.all(state);
    return {factor_ * sum(set_.comm(), std::inner_product(u.begin(), u.end(), u.begin(), 0.0))};
  }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    set_.add_derivative(set_.all(state), 2.0 * weight * factor_, state, adjoint);
  }

  std::optional<SumOfSquares<Dim>> squares(TermScaling scaling) const override {
    if (!settings_.offers_squares(scaling)) return std::nullopt;
    std::vector<int> axes(Dim);
    std::iota(axes.begin(), axes.end(), 0);
    return sum_of_squares(set_, linear_modes(set_, axes, true), factor_, settings_.least_squares.has_value());
  }

 private:
  SetDisplacement<Dim> set_;
  DistortionSettings settings_;
  double factor_;
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_displacement(const SetDisplacement<Dim>& set,
                                                 const DistortionSettings& settings) {
  return std::make_unique<Displacement<Dim>>(set, settings);
}

FABSEQ_INSTANTIATE_FUNCTION(make_displacement);

}  // namespace fabseq
