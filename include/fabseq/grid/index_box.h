// SPDX-License-Identifier: MIT
/// \file
/// Points, indices and boxes of indices in `Dim` dimensions, x fastest.
#pragma once

#include "fabseq/base/formatted.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <string>

/// Explicit instantiation in 2D and 3D of a class template, of a struct template, or of a function template
/// that is not overloaded, whatever its arguments.
#define FABSEQ_INSTANTIATE_CLASS(Name) \
  template class Name<2>;              \
  template class Name<3>
#define FABSEQ_INSTANTIATE_STRUCT(Name) \
  template struct Name<2>;              \
  template struct Name<3>
#define FABSEQ_INSTANTIATE_FUNCTION(name) \
  template decltype(name<2>) name<2>;     \
  template decltype(name<3>) name<3>

namespace fabseq {

/// Coordinates of a point or components of a vector, [axis].
template <int Dim>
using Point = std::array<double, Dim>;

template <std::size_t Size>
double dot(const std::array<double, Size>& a, const std::array<double, Size>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Element or node index along each axis.
template <int Dim>
using Index = std::array<int, Dim>;

/// The same entry along all axes.
template <int Dim>
Index<Dim> uniform_index(int entry) {
  Index<Dim> result;
  result.fill(entry);
  return result;
}

/// "[1,2,3]" or "[0.5,1,1.5]", for messages.
template <int Dim>
std::string to_text(const Index<Dim>& index) {
  std::string text;
  for (const int value : index) {
    text += text.empty() ? "[" : ",";
    text += std::to_string(value);
  }
  return text + "]";
}

template <int Dim>
std::string to_text(const Point<Dim>& point) {
  std::string text;
  for (const double coordinate : point) {
    text += text.empty() ? "[" : ",";
    text += formatted("%.6g", coordinate);
  }
  return text + "]";
}

/// Number of nodes of an element. Node n lies at the upper end of axis a if bit a of n is set.
template <int Dim>
constexpr int corner_count = 1 << Dim;

/// The corner of an element (step 1), or the element at a node (step -1), of that number, 0 to 2^Dim - 1: bit
/// a stands for a step along axis a.
template <int Dim>
Index<Dim> stepped(const Index<Dim>& from, int number, int step) {
  Index<Dim> result = from;
  for (int axis = 0; axis < Dim; ++axis) result[axis] += step * (number >> axis & 1);
  return result;
}

/// All indices with start[a] <= index[a] < start[a] + size[a].
template <int Dim>
struct IndexBox {
  Index<Dim> start{};
  Index<Dim> size{};

  std::int64_t count() const {
    std::int64_t product = 1;
    for (const int extent : size) product *= extent;
    return product;
  }
  bool contains(const Index<Dim>& index) const {
    for (int axis = 0; axis < Dim; ++axis)
      if (index[axis] < start[axis] || index[axis] >= start[axis] + size[axis]) return false;
    return true;
  }
  /// Position of `index` in the lexicographic order of the box, x fastest.
  std::int64_t offset(const Index<Dim>& index) const {
    std::int64_t result = 0;
    for (int axis = Dim - 1; axis >= 0; --axis) result = result * size[axis] + (index[axis] - start[axis]);
    return result;
  }
  /// Inverse of offset().
  Index<Dim> index(std::int64_t offset) const {
    Index<Dim> result{};
    for (int axis = 0; axis < Dim; ++axis) {
      result[axis] = start[axis] + static_cast<int>(offset % size[axis]);
      offset /= size[axis];
    }
    return result;
  }
  /// What both boxes have; a box of no entries if they have nothing in common.
  IndexBox common_with(const IndexBox& other) const {
    IndexBox common;
    for (int axis = 0; axis < Dim; ++axis) {
      common.start[axis] = std::max(start[axis], other.start[axis]);
      const int end = std::min(start[axis] + size[axis], other.start[axis] + other.size[axis]);
      common.size[axis] = std::max(0, end - common.start[axis]);
    }
    return common;
  }
  /// The box of elements, `factors` times coarser, that those of this box lie in.
  IndexBox coarsened(const Index<Dim>& factors) const {
    IndexBox coarse;
    for (int axis = 0; axis < Dim; ++axis) {
      coarse.start[axis] = start[axis] / factors[axis];
      const int end = (start[axis] + size[axis] + factors[axis] - 1) / factors[axis];
      coarse.size[axis] = end - coarse.start[axis];
    }
    return coarse;
  }
  /// Calls f(index, offset) for all indices in lexicographic order.
  template <class Function>
  void for_each(Function&& f) const {
    const std::int64_t total = count();
    for (std::int64_t o = 0; o < total; ++o) f(index(o), o);
  }
};

/// `box` extended by `width` at both ends of each axis, beyond the grid, too.
template <int Dim>
IndexBox<Dim> ringed(IndexBox<Dim> box, const Index<Dim>& width = uniform_index<Dim>(1)) {
  for (int axis = 0; axis < Dim; ++axis) {
    box.start[axis] -= width[axis];
    box.size[axis] += 2 * width[axis];
  }
  return box;
}

}  // namespace fabseq
