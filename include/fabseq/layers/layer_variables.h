// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/layers/layer_settings.h"

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Design variables of the layers themselves, beside the sequence's: time points or print angles. They are
/// few and the same on all ranks; without any, all lists are empty.
struct LayerVariables {
  std::string name;                  ///< in files: time_points, angles
  std::string label;                 ///< in messages
  std::vector<double> start;         ///< the design to start from
  std::vector<double> lower, upper;  ///< bounds
  /// The optimizer's range of a variable: so far to either side of where it is, within the bounds.
  double reach = std::numeric_limits<double>::infinity();
  /// In files: a table with so many columns, [sub-part][angle]; 0: a plain list.
  int columns = 0;
  bool fixed = false;  ///< part of every design, but kept from the optimizer

  std::size_t count() const { return start.size(); }
  /// Values as a list, or per sub-part a list.
  Json record(std::span<const double> values) const;
};

/// T_1 ... T_{N-1} of curved layers (docs/formulation.md 3.1); one layer has none.
LayerVariables time_point_variables(int layers);
/// Angles of the print directions of multi-planar layers (3.2). `longest_edge`: of the part.
LayerVariables angle_variables(const MultiPlanarSettings& settings, int dimension, double longest_edge);

}  // namespace fabseq
