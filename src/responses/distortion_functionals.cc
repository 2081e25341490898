// SPDX-License-Identifier: MIT
#include "responses/distortion_functionals.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

namespace {

/// The functions 1, x, y, z, made orthonormal over the set's nodes; those that depend on the ones before are
/// left out. Collective.
template <int Dim>
OrthonormalFunctions linear_functions(const SetDisplacement<Dim>& set) {
  const std::vector<int>& nodes = set.nodes().owned;
  OrthonormalFunctions result(set.comm());
  result.add(SetFunction(nodes.size(), 1.0), 0.0);
  double size = 0.0;
  for (const int node : nodes)
    for (const double coordinate : set.position(node)) size = std::max(size, std::abs(coordinate));
  const double least =
      dependent_share * std::sqrt(static_cast<double>(set.nodes().count)) * max(set.comm(), size);
  for (int axis = 0; axis < Dim; ++axis) {
    SetFunction function;
    for (const int node : nodes) function.push_back(set.position(node)[axis]);
    result.add(std::move(function), least);
  }
  return result;
}

template <int Dim>
class DistortionFunctionals : public Response<Dim> {
 public:
  DistortionFunctionals(const SetDisplacement<Dim>& set, std::vector<SetFunction> modes,
                        double root_of_factor)
      : set_(set), modes_(std::move(modes)), root_of_factor_(root_of_factor) {}

  bool uses_displacements() const override { return true; }
  std::vector<double> values(const StageResults<Dim>& state) const override {
    const SetFunction displacement = set_.all(state);
    std::vector<double> result;
    for (const SetFunction& mode : modes_)
      result.push_back(root_of_factor_ *
                       std::inner_product(mode.begin(), mode.end(), displacement.begin(), 0.0));
    sum_in_place(set_.comm(), result);
    return result;
  }
  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    set_.add_derivative(modes_[component], weight * root_of_factor_, state, adjoint);
  }

 private:
  SetDisplacement<Dim> set_;
  std::vector<SetFunction> modes_;
  double root_of_factor_;
};

}  // namespace

double OrthonormalFunctions::dot(const SetFunction& a, const SetFunction& b) const {
  return sum(comm_, std::inner_product(a.begin(), a.end(), b.begin(), 0.0));
}

bool OrthonormalFunctions::add(SetFunction function, double least) {
  for (int pass = 0; pass < 2; ++pass)  // the second against rounding
    for (const SetFunction& other : functions_) {
      const double part = dot(other, function);
      for (std::size_t i = 0; i < function.size(); ++i) function[i] -= part * other[i];
    }
  const double norm = std::sqrt(dot(function, function));
  if (norm <= least) return false;
  for (double& value : function) value /= norm;
  functions_.push_back(std::move(function));
  return true;
}

void OrthonormalFunctions::remove_from(SetFunction& function) const {
  std::vector<double> shares;
  for (const SetFunction& other : functions_)
    shares.push_back(std::inner_product(other.begin(), other.end(), function.begin(), 0.0));
  sum_in_place(comm_, shares);
  for (std::size_t k = 0; k < shares.size(); ++k)
    for (std::size_t i = 0; i < function.size(); ++i) function[i] -= shares[k] * functions_[k][i];
}

template <int Dim>
SetModes linear_modes(const SetDisplacement<Dim>& set, const std::vector<int>& axes, bool means) {
  const OrthonormalFunctions linear = linear_functions(set);
  SetModes result;
  result.complete = static_cast<std::int64_t>(linear.count()) == set.nodes().count;
  for (const int axis : axes)
    for (std::size_t k = means ? 0 : 1; k < linear.count(); ++k) {
      const SetFunction& function = linear.functions()[k];
      SetFunction& mode = result.modes.emplace_back(Dim * function.size(), 0.0);
      for (std::size_t i = 0; i < function.size(); ++i) mode[i * Dim + axis] = function[i];
    }
  return result;
}

template <int Dim>
std::optional<SumOfSquares<Dim>> sum_of_squares(const SetDisplacement<Dim>& set, SetModes modes,
                                                double factor, bool asked_for) {
  if (modes.modes.empty()) return std::nullopt;
  const auto count = static_cast<int>(modes.modes.size());
  return SumOfSquares<Dim>{
      std::make_unique<DistortionFunctionals<Dim>>(set, std::move(modes.modes), std::sqrt(factor)), count,
      modes.complete, asked_for};
}

FABSEQ_INSTANTIATE_FUNCTION(linear_modes);
FABSEQ_INSTANTIATE_FUNCTION(sum_of_squares);

}  // namespace fabseq
