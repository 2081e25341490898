#include "fabseq/responses/minimum_layer_volume.h"

#include "fabseq/base/mpi.h"

namespace fabseq {

namespace {

template <int Dim>
class MinimumLayerVolume : public Response<Dim> {
 public:
  MinimumLayerVolume(const ResponseContext<Dim>& context, double fraction)
      : comm_(context.part.grid().comm()),
        element_volume_(context.part.grid().element_volume()),
        least_(fraction * context.part.volume()) {}

  std::string type() const override { return "minimum_layer_volume"; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    std::vector<double> result(state.layers.count(), 0.0);
    for (std::size_t j = 0; j < result.size(); ++j)
      for (const double density : state.layers.layer[j]) result[j] += density * element_volume_;
    sum_in_place(comm_, result);
    for (double& value : result) value = least_ - value;
    return result;
  }

  void add_derivative(int component, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    auto& d_layer =
        DensityDerivatives::touch(adjoint.densities.layer[component], state.layers.layer[component].size());
    for (double& derivative : d_layer) derivative -= weight * element_volume_;
  }

  /// The margin is a share of the least volume: there is no other length on the scale of the allowed.
  std::vector<ConstraintRow> rows(int components, double margin) const override {
    std::vector<ConstraintRow> result;
    for (int j = 0; j < components; ++j) result.push_back({j, 1.0, -(1.0 - margin) * least_, least_});
    return result;
  }

 private:
  MPI_Comm comm_;
  double element_volume_, least_;
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
