// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/model/model.h"
#include "fabseq/report/build_report.h"

#include <array>
#include <cstdint>
#include <vector>

namespace fabseq {

/// A pseudo-time cut into binary layers, and what the exact checks say of them.
template <int Dim>
struct CutTime {
  PseudoTime<Dim> time;
  LayerDensities densities;
  std::vector<double> layer;  ///< of each part element, from 1
  /// Amounts by which each part element fails each check, > 0 where it does; empty: the check is not made.
  std::array<std::vector<double>, all_faults.size()> marks;
  std::array<std::int64_t, all_faults.size()> failing{};  ///< elements over all ranks

  /// Whether a part element of this rank fails a check.
  bool fails(std::size_t element) const;
  /// Elements that fail, once for each check.
  std::int64_t in_all() const;
  /// Whether fewer elements fail than in another one, and of none of the checks more.
  bool is_better_than(const CutTime& other) const;
};

/// Cuts and checks. Collective on the grid's communicator.
template <int Dim>
CutTime<Dim> cut(const Model<Dim>& model, const Layers& layers, PseudoTime<Dim> time);

/// Part elements that are in another layer, over all ranks. Collective on the grid's communicator.
template <int Dim>
std::int64_t count_moved(const Part<Dim>& part, const CutTime<Dim>& from, const CutTime<Dim>& to);

/// Number in the whole grid of a part element.
template <int Dim>
std::int64_t number_in_grid(const Part<Dim>& part, std::size_t element) {
  return part.grid().all_elements().offset(part.grid().owned_elements().index(part.elements()[element]));
}

}  // namespace fabseq
