// SPDX-License-Identifier: MIT
#include "fabseq/responses/minimum_layer_volume.h"

#include "fabseq/responses/layer_statistics.h"

namespace fabseq {

namespace {

template <int Dim>
class MinimumLayerVolume : public Response<Dim> {
 public:
  MinimumLayerVolume(const ResponseContext<Dim>& context, double fraction)
      : grid_(context.part.grid()), least_(fraction * context.part.volume()) {}

  std::string type() const override { return "minimum_layer_volume"; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    std::vector<double> result = layer_volumes(grid_, state.layers);
    for (double& value : result) value = least_ - value;
    return result;
  }

  void add_derivative(int component, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    auto& d_layer =
        DensityDerivatives::touch(adjoint.densities.layer[component], state.layers.layer[component].size());
    const double element_volume = grid_.element_volume();
    for (double& derivative : d_layer) derivative -= weight * element_volume;
  }

  /// The margin is a share of the least volume: there is no other length on the scale of the allowed.
  std::vector<ConstraintRow> rows(int components, double margin) const override {
    std::vector<ConstraintRow> result;
    for (int j = 0; j < components; ++j) result.push_back({j, 1.0, -(1.0 - margin) * least_, least_});
    return result;
  }

 private:
  const Grid<Dim>& grid_;
  double least_;
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_minimum_layer_volume(const ResponseContext<Dim>& context,
                                                         double fraction) {
  return std::make_unique<MinimumLayerVolume<Dim>>(context, fraction);
}

template std::unique_ptr<Response<2>> make_minimum_layer_volume<2>(const ResponseContext<2>&, double);
template std::unique_ptr<Response<3>> make_minimum_layer_volume<3>(const ResponseContext<3>&, double);

}  // namespace fabseq
