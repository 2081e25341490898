// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Names and values of element and node fields on a grid, for any writer. The set owns neither: grid and
/// values must outlive it.
template <int Dim>
struct FieldSet {
  struct Field {
    std::string name;
    bool on_nodes = false;
    int components = 1;
    std::span<const double> values;  ///< [owned entity][component], lexicographic in the owned box
    bool single_precision = false;   ///< stored as 32-bit floats
  };

  const Grid<Dim>* grid = nullptr;
  std::vector<Field> fields;

  /// Adds a field on the nodes or elements, in double precision, with `components` values per node or
  /// element.
  void add(bool on_nodes, const std::string& name, std::span<const double> values, int components = 1) {
    fields.push_back({name, on_nodes, components, values, false});
  }
  void add_elements(const std::string& name, std::span<const double> values, int components = 1) {
    add(false, name, values, components);
  }
  void add_nodes(const std::string& name, std::span<const double> values, int components = 1) {
    add(true, name, values, components);
  }
};

}  // namespace fabseq
