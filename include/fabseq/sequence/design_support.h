// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// The *places* of the design variables: the elements or nodes that have one. Entry i of a design belongs to
/// place i. Nothing here is collective.
template <int Dim>
class DesignSupport {
 public:
  /// `places`: this rank's, as offsets in Grid::owned_elements() or Grid::owned_nodes(), ascending. The grid
  /// must outlive the object.
  DesignSupport(const Grid<Dim>& grid, bool on_nodes, std::vector<int> places)
      : grid_(grid), on_nodes_(on_nodes), places_(std::move(places)) {}

  bool on_nodes() const { return on_nodes_; }
  const std::vector<int>& places() const { return places_; }
  /// Number of variables of this rank.
  std::size_t size() const { return places_.size(); }

  /// Field on all owned elements or nodes of the grid, with the values of the variables at their places and 0
  /// elsewhere.
  std::vector<double> expand(std::span<const double> variables) const {
    const std::int64_t count = on_nodes_ ? grid_.owned_nodes().count() : grid_.owned_elements().count();
    std::vector<double> field(static_cast<std::size_t>(count), 0.0);
    for (std::size_t i = 0; i < places_.size(); ++i) field[places_[i]] = variables[i];
    return field;
  }
  /// Values at the places of the variables, from a field on all owned elements or nodes.
  std::vector<double> restrict_to_variables(std::span<const double> field) const {
    std::vector<double> variables;
    for (const int place : places_) variables.push_back(field[place]);
    return variables;
  }
  /// Lexicographic number of a variable's place in the whole grid.
  std::int64_t number(std::size_t variable) const {
    return on_nodes_ ? grid_.all_nodes().offset(grid_.owned_nodes().index(places_[variable]))
                     : grid_.all_elements().offset(grid_.owned_elements().index(places_[variable]));
  }

 private:
  const Grid<Dim>& grid_;
  bool on_nodes_;
  std::vector<int> places_;
};

}  // namespace fabseq
