// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "repair/cut_time.h"
#include "repair/place_limit.h"

#include <vector>

namespace fabseq {

/// Changes the times of nodes so that elements that fail a check of their binary layers fail none: place by
/// place, by steps that lower the smooth counts of these elements alone (docs/developer/repair.md 13.5).
/// Calls are collective on the grid's communicator.
template <int Dim>
class TimeMending {
 public:
  /// Model and layers must outlive the object.
  TimeMending(const Model<Dim>& model, const Layers& layers);

  /// The best layers on the way, of which no more than `most_elements` went to another layer; those of
  /// `start` if none are better or the times of its nodes are not known.
  CutTime<Dim> mend(const CutTime<Dim>& start, double most_elements);

 private:
  CutTime<Dim> mend_place(const CutTime<Dim>& start, const std::vector<double>& place, int smoothing);
  std::vector<std::vector<double>> places_of(const CutTime<Dim>& cut) const;
  bool still_fails(const CutTime<Dim>& cut, const std::vector<double>& place) const;
  std::vector<double> smoothed(std::vector<double> nodal, int times) const;
  double count_of(const CutTime<Dim>& cut);
  bool step(const PseudoTime<Dim>& from, CutTime<Dim>& now, std::vector<double>& nodal, int smoothing);
  PseudoTime<Dim> time_of(const PseudoTime<Dim>& from, const std::vector<double>& nodal) const;

  const Model<Dim>& model_;
  const Layers& layers_;
  ElementMatrices<Dim> element_;
  std::vector<PlaceLimit<Dim>> limits_;
  std::vector<std::size_t> checks_;  ///< of the limits, index in all_faults
};

}  // namespace fabseq
