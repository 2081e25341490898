// SPDX-License-Identifier: MIT
/// \file
/// Boxes of elements of which only some are there, and sums over those elements by plain loops.
#pragma once

#include "fabseq/grid/index_box.h"
#include "support/small_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace fabseq::test {

/// Which elements of a grid are in the model, by their index in the grid.
template <int Dim>
struct Mask {
  std::string name;
  std::function<bool(const Index<Dim>&)> active;
};

/// Masks for a grid of about 5 to 50 elements an axis: with holes, thin walls, almost nothing, nothing.
template <int Dim>
std::vector<Mask<Dim>> masks() {
  const auto random = [](double fill) {
    return [fill](const Index<Dim>& element) {
      std::int64_t number = 0;
      for (const int i : element) number = number * 64 + i;
      return noise(number, 5) < fill;
    };
  };
  return {{"full", [](const Index<Dim>&) { return true; }},
          {"half", random(0.5)},
          {"almost empty", random(0.02)},
          {"walls", [](const Index<Dim>& e) { return e[0] % 4 == 2 || e[Dim - 1] % 3 == 1; }},
          {"sticks", [](const Index<Dim>& e) { return e[1] % 2 == 0 && e[Dim - 1] % 2 == 0; }},
          {"one corner", [](const Index<Dim>& e) { return *std::max_element(e.begin(), e.end()) < 2; }},
          {"none", [](const Index<Dim>&) { return false; }}};
}

/// A part of a grid with a mask.
template <int Dim>
struct MaskedBox {
  MaskedBox(const IndexBox<Dim>& box, const Mask<Dim>& mask) : name(mask.name), elements(box), nodes(box) {
    for (int& extent : nodes.size) ++extent;
    elements.for_each([&](const Index<Dim>& index, std::int64_t) {
      active.push_back(mask.active(index) ? 1 : 0);
      name += index == elements.start ? " from " + to_text<Dim>(index) : "";
    });
  }

  /// f(index, offset) of the elements that are there.
  template <class Function>
  void for_each_active(Function&& f) const {
    elements.for_each([&](const Index<Dim>& index, std::int64_t offset) {
      if (active[offset] != 0) f(index, offset);
    });
  }
  /// How many of an element's corners each node of the box is.
  std::vector<int> touching_elements() const {
    std::vector<int> result(static_cast<std::size_t>(nodes.count()), 0);
    for_each_active([&](const Index<Dim>& index, std::int64_t) {
      for (int corner = 0; corner < corner_count<Dim>; ++corner)
        ++result[nodes.offset(corner_node(index, corner))];
    });
    return result;
  }
  static Index<Dim> corner_node(Index<Dim> element, int corner) {
    for (int axis = 0; axis < Dim; ++axis) element[axis] += (corner >> axis) & 1;
    return element;
  }

  std::string name;
  IndexBox<Dim> elements, nodes;
  std::vector<char> active;  ///< lexicographic
};

/// All masks on boxes with different starts and odd sizes.
template <int Dim>
std::vector<MaskedBox<Dim>> masked_boxes() {
  // The last: rows longer than a register.
  constexpr int count = 5;
  std::vector<IndexBox<Dim>> boxes(count);
  const int sizes[count][3] = {{9, 5, 7}, {6, 7, 4}, {1, 3, 2}, {5, 1, 3}, {37, 3, 2}};
  for (int i = 0; i < count; ++i)
    for (int axis = 0; axis < Dim; ++axis) {
      boxes[i].start[axis] = i == 1 ? 3 + axis : 0;
      boxes[i].size[axis] = sizes[i][axis];
    }
  std::vector<MaskedBox<Dim>> result;
  for (const auto& box : boxes)
    for (const auto& mask : masks<Dim>()) result.emplace_back(box, mask);
  return result;
}

/// K x of elements that are summed up one by one, and how large the terms of the sums are.
struct PlainProduct {
  std::vector<double> value;  ///< [node of the box][component]
  std::vector<double> scale;  ///< [node of the box]
};

/// `matrix(offset)`: of an active element, row by row. `x`: [node of the box][component].
template <int Dim, class Matrix>
PlainProduct multiply(const MaskedBox<Dim>& box, int components, Matrix&& matrix,
                      const std::vector<double>& x) {
  const int rows = corner_count<Dim> * components;
  PlainProduct result{std::vector<double>(x.size(), 0.0), std::vector<double>(x.size() / components, 0.0)};
  box.for_each_active([&](const Index<Dim>& index, std::int64_t offset) {
    const std::vector<double> entries = matrix(offset);
    std::vector<std::size_t> unknowns;
    for (int corner = 0; corner < corner_count<Dim>; ++corner)
      for (int a = 0; a < components; ++a)
        unknowns.push_back(box.nodes.offset(box.corner_node(index, corner)) * components + a);
    double scale = 0.0;
    for (int j = 0; j < rows; ++j) scale = std::max(scale, rows * std::abs(x[unknowns[j]]));
    scale *= largest(entries);
    for (int i = 0; i < rows; ++i) {
      result.scale[unknowns[i] / components] += scale / components;
      for (int j = 0; j < rows; ++j) result.value[unknowns[i]] += entries[i * rows + j] * x[unknowns[j]];
    }
  });
  return result;
}

/// A stiffness between 1e-9 and 1, of an element and lane: neighbours may differ by all of that.
inline double wild_factor(std::int64_t element, int lane) {
  return std::pow(10.0, -9.0 * noise(element, 20 + lane));
}

/// f.operator()<Width>() for all widths.
template <class Function>
void for_each_width(Function&& f) {
  f.template operator()<1>();
  f.template operator()<2>();
  f.template operator()<4>();
  f.template operator()<8>();
}

}  // namespace fabseq::test
