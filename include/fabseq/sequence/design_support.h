// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// The *places* of the design variables: the elements or nodes that have some. Each place has the same number
/// of components, and a design has an entry for each, [place][component]. Nothing here is collective.
template <int Dim>
class DesignSupport {
 public:
  /// `places`: this rank's, as offsets in Grid::owned_elements() or Grid::owned_nodes(), ascending. The grid
  /// must outlive the object.
  DesignSupport(const Grid<Dim>& grid, bool on_nodes, std::vector<int> places, int components = 1)
      : grid_(grid), on_nodes_(on_nodes), places_(std::move(places)), components_(components) {}

  bool on_nodes() const { return on_nodes_; }
  const std::vector<int>& places() const { return places_; }
  /// Number of variables of a place.
  int components() const { return components_; }
  /// Number of variables of this rank.
  std::size_t size() const { return places_.size() * components_; }

  /// Field on all owned elements or nodes of the grid, [element or node][component], with the values of the
  /// variables at their places and 0 elsewhere.
  std::vector<double> expand(std::span<const double> variables) const {
    const std::int64_t count = on_nodes_ ? grid_.owned_nodes().count() : grid_.owned_elements().count();
    std::vector<double> field(static_cast<std::size_t>(count) * components_, 0.0);
    for (std::size_t i = 0; i < size(); ++i) field[in_field(i)] = variables[i];
    return field;
  }
  /// Values at the places of the variables, from a field on all owned elements or nodes.
  std::vector<double> restrict_to_variables(std::span<const double> field) const {
    std::vector<double> variables;
    for (std::size_t i = 0; i < size(); ++i) variables.push_back(field[in_field(i)]);
    return variables;
  }
  /// Number of a variable in a field on the whole grid, [element or node][component].
  std::int64_t number(std::size_t variable) const {
    const int place = places_[variable / components_];
    const std::int64_t in_grid = on_nodes_ ? grid_.all_nodes().offset(grid_.owned_nodes().index(place))
                                           : grid_.all_elements().offset(grid_.owned_elements().index(place));
    return in_grid * components_ + static_cast<std::int64_t>(variable % components_);
  }

 private:
  /// Where a variable is in a field on all owned elements or nodes.
  std::size_t in_field(std::size_t variable) const {
    return static_cast<std::size_t>(places_[variable / components_]) * components_ + variable % components_;
  }

  const Grid<Dim>& grid_;
  bool on_nodes_;
  std::vector<int> places_;
  int components_;
};

}  // namespace fabseq
