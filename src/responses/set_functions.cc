// SPDX-License-Identifier: MIT
#include "fabseq/responses/set_functions.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

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
Point<Dim> SetExtent<Dim>::relative(Point<Dim> position) const {
  for (int axis = 0; axis < Dim; ++axis)
    position[axis] = (position[axis] - center[axis]) / (radius > 0.0 ? radius : 1.0);
  return position;
}

template <int Dim>
SetExtent<Dim> extent_of(const SetDisplacement<Dim>& set) {
  SetExtent<Dim> result;
  for (const int node : set.nodes().owned)
    for (int axis = 0; axis < Dim; ++axis) result.center[axis] += set.position(node)[axis];
  sum_in_place(set.comm(), result.center);
  for (double& coordinate : result.center) coordinate /= static_cast<double>(set.nodes().count);
  for (const int node : set.nodes().owned) {
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis)
      square += std::pow(set.position(node)[axis] - result.center[axis], 2);
    result.radius = std::max(result.radius, std::sqrt(square));
  }
  result.radius = max(set.comm(), result.radius);
  return result;
}

FABSEQ_INSTANTIATE_STRUCT(SetExtent);
FABSEQ_INSTANTIATE_FUNCTION(extent_of);

}  // namespace fabseq
