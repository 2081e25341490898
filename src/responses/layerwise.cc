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

  std::vector<double> values(const StageResults<Dim>& state) const override {
    double square = 0.0;
    for_each_layer(*state.process, [&](std::size_t, std::size_t, int, int, double u) { square += u * u; });
    return {sum(state.process->all_layers, square)};
  }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    auto& derivative = adjoint.process.increments;
    for (std::size_t block = derivative.size(); block < state.process->increments.size(); ++block) {
      const LaneVector& increments = state.process->increments[block];
      derivative.emplace_back(increments.nodes, increments.components, increments.lanes);
    }
    for_each_layer(*state.process, [&](std::size_t block, std::size_t unknown, int begin, int end, double u) {
      for (int lane = begin; lane < end; ++lane) derivative[block](unknown, lane) += 2.0 * weight * u;
    });
  }

 private:
  /// Calls f(block, unknown, first lane and end of the layer's steps, what counts of its increment) for each
  /// unknown in each layer.
  template <class Function>
  static void for_each_layer(const ProcessResult& process, Function&& f) {
    for (std::size_t block = 0; block < process.increments.size(); ++block) {
      const auto steps = process.steps_of(block);
      const int lanes = process.increments[block].lanes;
      for (std::size_t i = 0; i < process.increments[block].unknowns(); ++i)
        for (int begin = 0, end = 0; begin < lanes; begin = end) {
          double u = 0.0;
          for (; end < lanes && steps[end].layer == steps[begin].layer; ++end)
            u += process.counted(block, i, end);
          f(block, i, begin, end, u);
        }
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
