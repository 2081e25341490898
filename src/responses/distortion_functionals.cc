// SPDX-License-Identifier: MIT
#include "fabseq/responses/distortion_functionals.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

namespace {

/// A function over a node set, [owned node of the set].
using SetFunction = std::vector<double>;

/// A function counts as dependent on others if orthogonalization leaves at most this share of the size of the
/// box.
constexpr double dependent = 1e-9;

double dot(MPI_Comm comm, const SetFunction& a, const SetFunction& b) {
  return sum(comm, std::inner_product(a.begin(), a.end(), b.begin(), 0.0));
}

/// Orthogonalizes a function against the others, which are orthonormal; twice, against rounding. Collective.
void orthogonalize(MPI_Comm comm, const std::vector<SetFunction>& others, SetFunction& function) {
  for (int pass = 0; pass < 2; ++pass)
    for (const SetFunction& other : others) {
      const double part = dot(comm, other, function);
      for (std::size_t i = 0; i < function.size(); ++i) function[i] -= part * other[i];
    }
}

/// The functions 1, x, y, z, made orthonormal over the set's nodes; those that depend on the ones before are
/// left out. Collective.
template <int Dim>
std::vector<SetFunction> linear_functions(const SetDisplacement<Dim>& set) {
  const std::vector<int>& nodes = set.nodes().owned;
  const double root = std::sqrt(static_cast<double>(set.nodes().count));
  std::vector<SetFunction> result = {SetFunction(nodes.size(), 1.0 / root)};
  double size = 0.0;
  for (const int node : nodes)
    for (const double coordinate : set.position(node)) size = std::max(size, std::abs(coordinate));
  size = max(set.comm(), size);
  for (int axis = 0; axis < Dim; ++axis) {
    SetFunction function;
    for (const int node : nodes) function.push_back(set.position(node)[axis]);
    orthogonalize(set.comm(), result, function);
    const double norm = std::sqrt(dot(set.comm(), function, function));
    if (norm <= dependent * root * size) continue;
    for (double& value : function) value /= norm;
    result.push_back(std::move(function));
  }
  return result;
}

}  // namespace

template <int Dim>
DistortionFunctionals<Dim>::DistortionFunctionals(const SetDisplacement<Dim>& set, std::vector<int> axes,
                                                  bool means, double factor, bool asked_for)
    : set_(set),
      axes_(std::move(axes)),
      root_of_factor_(std::sqrt(factor)),
      asked_for_(asked_for),
      functions_(linear_functions(set)),
      complete_(static_cast<std::int64_t>(functions_.size()) == set.nodes().count) {
  if (!means) functions_.erase(functions_.begin());
}

template <int Dim>
std::vector<double> DistortionFunctionals<Dim>::values(const PipelineState<Dim>& state) const {
  const std::vector<int>& nodes = set_.nodes().owned;
  std::vector<double> result;
  for (const int axis : axes_)
    for (const SetFunction& function : functions_) {
      double product = 0.0;
      for (std::size_t i = 0; i < nodes.size(); ++i) product += function[i] * set_.at(state, nodes[i], axis);
      result.push_back(root_of_factor_ * product);
    }
  sum_in_place(set_.comm(), result);
  return result;
}

template <int Dim>
void DistortionFunctionals<Dim>::add_derivative(int component, double weight, const PipelineState<Dim>& state,
                                                PipelineAdjoint<Dim>& adjoint) const {
  const auto functions = static_cast<int>(functions_.size());
  const int axis = axes_[component / functions];
  const SetFunction& function = functions_[component % functions];
  const std::vector<int>& nodes = set_.nodes().owned;
  set_.prepare(state, adjoint);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    set_.add_derivative(nodes[i], axis, weight * root_of_factor_ * function[i], state, adjoint);
}

template class DistortionFunctionals<2>;
template class DistortionFunctionals<3>;

}  // namespace fabseq
