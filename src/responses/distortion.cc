#include "fabseq/responses/distortion.h"

#include "fabseq/base/mpi.h"

namespace fabseq {

namespace {

template <int Dim>
std::vector<double>& touch_displacement(const PipelineState<Dim>& state, PipelineAdjoint<Dim>& adjoint) {
  if (adjoint.process.displacement.empty())
    adjoint.process.displacement.assign(state.process.displacement.size(), 0.0);
  return adjoint.process.displacement;
}

template <int Dim>
class Displacement : public Response<Dim> {
 public:
  Displacement(const Part<Dim>& part, const NodeSet& nodes, bool mean)
      : comm_(part.grid().comm()),
        nodes_(nodes),
        factor_(mean ? 1.0 / static_cast<double>(nodes.count) : 1.0) {}

  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    double square = 0.0;
    for (const int node : nodes_.owned)
      for (int axis = 0; axis < Dim; ++axis) {
        const double u = state.process.displacement[static_cast<std::size_t>(node) * Dim + axis];
        square += u * u;
      }
    return {factor_ * sum(comm_, square)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    auto& derivative = touch_displacement(state, adjoint);
    for (const int node : nodes_.owned)
      for (int axis = 0; axis < Dim; ++axis) {
        const std::size_t i = static_cast<std::size_t>(node) * Dim + axis;
        derivative[i] += 2.0 * weight * factor_ * state.process.displacement[i];
      }
  }

 private:
  MPI_Comm comm_;
  const NodeSet& nodes_;
  double factor_;
};

template <int Dim>
class Flatness : public Response<Dim> {
 public:
  Flatness(const Part<Dim>& part, const NodeSet& nodes, int axis)
      : comm_(part.grid().comm()), nodes_(nodes), axis_(axis) {}

  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    const double average = mean(state);
    double square = 0.0;
    for (const int node : nodes_.owned) {
      const double deviation = component(state, node) - average;
      square += deviation * deviation;
    }
    return {sum(comm_, square) / static_cast<double>(nodes_.count)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    // The mean's own derivative drops out: deviations sum to zero.
    const double average = mean(state);
    auto& derivative = touch_displacement(state, adjoint);
    for (const int node : nodes_.owned)
      derivative[static_cast<std::size_t>(node) * Dim + axis_] +=
          2.0 * weight / static_cast<double>(nodes_.count) * (component(state, node) - average);
  }

 private:
  double component(const PipelineState<Dim>& state, int node) const {
    return state.process.displacement[static_cast<std::size_t>(node) * Dim + axis_];
  }
  double mean(const PipelineState<Dim>& state) const {
    double total = 0.0;
    for (const int node : nodes_.owned) total += component(state, node);
    return sum(comm_, total) / static_cast<double>(nodes_.count);
  }

  MPI_Comm comm_;
  const NodeSet& nodes_;
  int axis_;
};

template <int Dim>
class Layerwise : public Response<Dim> {
 public:
  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    double square = 0.0;
    for (const LaneVector& batch : state.process.increments)
      for (const double u : batch.values) square += u * u;
    return {sum(state.process.all_layers, square)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    auto& derivative = adjoint.process.increments;
    for (std::size_t batch = 0; batch < state.process.increments.size(); ++batch) {
      const LaneVector& increments = state.process.increments[batch];
      if (derivative.size() <= batch)
        derivative.emplace_back(increments.nodes, increments.components, increments.lanes);
      for (std::size_t i = 0; i < increments.values.size(); ++i)
        derivative[batch].values[i] += 2.0 * weight * increments.values[i];
    }
  }
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_displacement_distortion(const Part<Dim>& part, const NodeSet& nodes,
                                                            bool mean) {
  return std::make_unique<Displacement<Dim>>(part, nodes, mean);
}

template <int Dim>
std::unique_ptr<Response<Dim>> make_flatness_distortion(const Part<Dim>& part, const NodeSet& nodes,
                                                        int axis) {
  return std::make_unique<Flatness<Dim>>(part, nodes, axis);
}

template <int Dim>
std::unique_ptr<Response<Dim>> make_layerwise_distortion() {
  return std::make_unique<Layerwise<Dim>>();
}

#define FABSEQ_INSTANTIATE(Dim)                                                                           \
  template std::unique_ptr<Response<Dim>> make_displacement_distortion<Dim>(const Part<Dim>&,             \
                                                                            const NodeSet&, bool);        \
  template std::unique_ptr<Response<Dim>> make_flatness_distortion<Dim>(const Part<Dim>&, const NodeSet&, \
                                                                        int);                             \
  template std::unique_ptr<Response<Dim>> make_layerwise_distortion<Dim>();
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
