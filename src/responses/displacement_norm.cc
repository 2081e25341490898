// SPDX-License-Identifier: MIT
/// Distortion measure `displacement` with a `norm`.
#include "fabseq/base/mpi.h"
#include "responses/distortion_measures.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// All is divided by the largest |u|, so that high powers neither overflow nor vanish.
template <int Dim>
class DisplacementNorm : public Response<Dim> {
 public:
  DisplacementNorm(const SetDisplacement<Dim>& set, double power) : set_(set), power_(power) {}

  bool uses_displacements() const override { return true; }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const Sizes sizes = sizes_at(state);
    return {sizes.largest * sizes.largest * std::pow(sizes.mean_power, 2.0 / power_)};
  }

  /// dJ/du_i = (2/n) S^(2/p - 1) (|u_i| / largest)^(p - 2) u_i with S the mean of (|u| / largest)^p.
  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const Sizes sizes = sizes_at(state);
    set_.prepare(state, adjoint);
    if (sizes.largest == 0.0) return;
    const double factor = 2.0 * weight / static_cast<double>(set_.nodes().count) *
                          std::pow(sizes.mean_power, 2.0 / power_ - 1.0);
    SetFunction derivative = set_.all(state);
    for (std::size_t i = 0; i < sizes.relative.size(); ++i)
      for (int axis = 0; axis < Dim; ++axis)
        derivative[i * Dim + axis] *= std::pow(sizes.relative[i], power_ - 2.0);
    set_.add_derivative(derivative, factor, state, adjoint);
  }

 private:
  struct Sizes {
    double largest = 0.0;          ///< |u| over all ranks, length unit
    double mean_power = 0.0;       ///< of the relative sizes, over all ranks
    std::vector<double> relative;  ///< |u| over the largest, [owned node of the set]
  };

  Sizes sizes_at(const StageResults<Dim>& state) const {
    Sizes result;
    const SetFunction u = set_.all(state);
    for (std::size_t i = 0; i < u.size(); i += Dim) {
      const double size = std::hypot(u[i], u[i + 1], Dim == 3 ? u[i + Dim - 1] : 0.0);
      result.relative.push_back(size);
      result.largest = std::max(result.largest, size);
    }
    result.largest = max(set_.comm(), result.largest);
    if (result.largest == 0.0) return result;
    for (double& size : result.relative) {
      size /= result.largest;
      result.mean_power += std::pow(size, power_);
    }
    result.mean_power = sum(set_.comm(), result.mean_power) / static_cast<double>(set_.nodes().count);
    return result;
  }

  SetDisplacement<Dim> set_;
  double power_;
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_displacement_norm(const SetDisplacement<Dim>& set,
                                                      const DistortionSettings& settings) {
  return std::make_unique<DisplacementNorm<Dim>>(set, settings.norm.value());
}

FABSEQ_INSTANTIATE_FUNCTION(make_displacement_norm);

}  // namespace fabseq
