// SPDX-License-Identifier: MIT
#include "fabseq/responses/distortion.h"

#include "fabseq/base/mpi.h"
#include "fabseq/responses/set_displacement.h"

namespace fabseq {

namespace {

template <int Dim>
class Displacement : public Response<Dim> {
 public:
  Displacement(const SetDisplacement<Dim>& set, bool mean)
      : set_(set), factor_(mean ? 1.0 / static_cast<double>(set.nodes().count) : 1.0) {}

  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    double square = 0.0;
    for (const int node : set_.nodes().owned)
      for (int axis = 0; axis < Dim; ++axis) {
        const double u = set_.at(state, node, axis);
        square += u * u;
      }
    return {factor_ * sum(set_.comm(), square)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    set_.prepare(state, adjoint);
    for (const int node : set_.nodes().owned)
      for (int axis = 0; axis < Dim; ++axis)
        set_.add_derivative(node, axis, 2.0 * weight * factor_ * set_.at(state, node, axis), state, adjoint);
  }

 private:
  SetDisplacement<Dim> set_;
  double factor_;
};

template <int Dim>
class Flatness : public Response<Dim> {
 public:
  Flatness(const SetDisplacement<Dim>& set, int axis) : set_(set), axis_(axis) {}

  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    const double average = mean(state);
    double square = 0.0;
    for (const int node : set_.nodes().owned) {
      const double deviation = set_.at(state, node, axis_) - average;
      square += deviation * deviation;
    }
    return {sum(set_.comm(), square) / static_cast<double>(set_.nodes().count)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    // The mean's own derivative drops out: deviations sum to zero.
    const double average = mean(state);
    set_.prepare(state, adjoint);
    for (const int node : set_.nodes().owned) {
      const double deviation = set_.at(state, node, axis_) - average;
      set_.add_derivative(node, axis_, 2.0 * weight / static_cast<double>(set_.nodes().count) * deviation,
                          state, adjoint);
    }
  }

 private:
  double mean(const PipelineState<Dim>& state) const {
    double total = 0.0;
    for (const int node : set_.nodes().owned) total += set_.at(state, node, axis_);
    return sum(set_.comm(), total) / static_cast<double>(set_.nodes().count);
  }

  SetDisplacement<Dim> set_;
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
                                                            bool mean, bool after_release) {
  return std::make_unique<Displacement<Dim>>(SetDisplacement<Dim>(part, nodes, after_release), mean);
}

template <int Dim>
std::unique_ptr<Response<Dim>> make_flatness_distortion(const Part<Dim>& part, const NodeSet& nodes, int axis,
                                                        bool after_release) {
  return std::make_unique<Flatness<Dim>>(SetDisplacement<Dim>(part, nodes, after_release), axis);
}

template <int Dim>
std::unique_ptr<Response<Dim>> make_layerwise_distortion() {
  return std::make_unique<Layerwise<Dim>>();
}

#define FABSEQ_INSTANTIATE(Dim)                                                                           \
  template std::unique_ptr<Response<Dim>> make_displacement_distortion<Dim>(const Part<Dim>&,             \
                                                                            const NodeSet&, bool, bool);  \
  template std::unique_ptr<Response<Dim>> make_flatness_distortion<Dim>(const Part<Dim>&, const NodeSet&, \
                                                                        int, bool);                       \
  template std::unique_ptr<Response<Dim>> make_layerwise_distortion<Dim>();
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
