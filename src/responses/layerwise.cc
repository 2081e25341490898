// SPDX-License-Identifier: MIT
/// Distortion measure `layerwise`.
#include "fabseq/base/mpi.h"
#include "responses/distortion_measures.h"

namespace fabseq {

namespace {

template <int Dim>
class Layerwise : public Response<Dim> {
 public:
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    double square = 0.0;
    const auto& increments = state.process.increments;
    for (std::size_t batch = 0; batch < increments.size(); ++batch)
      for (std::size_t i = 0; i < increments[batch].unknowns(); ++i)
        for (int lane = 0; lane < increments[batch].lanes; ++lane) {
          const double u = state.process.counted(batch, i, lane);
          square += u * u;
        }
    return {sum(state.process.all_layers, square)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    auto& derivative = adjoint.process.increments;
    for (std::size_t batch = 0; batch < state.process.increments.size(); ++batch) {
      const LaneVector& increments = state.process.increments[batch];
      if (derivative.size() <= batch)
        derivative.emplace_back(increments.nodes, increments.components, increments.lanes);
      for (std::size_t i = 0; i < increments.unknowns(); ++i)
        for (int lane = 0; lane < increments.lanes; ++lane)
          derivative[batch](i, lane) += 2.0 * weight * state.process.counted(batch, i, lane);
    }
  }
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_layerwise() {
  return std::make_unique<Layerwise<Dim>>();
}

FABSEQ_INSTANTIATE_FUNCTION(make_layerwise);

}  // namespace fabseq
