// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/sequence/sequence.h"

#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// A sequence without design variables (docs/formulation.md 3.3, 3.1): a pseudo-time that stays as it is.
template <int Dim>
class GivenSequence : public Sequence<Dim> {
 public:
  explicit GivenSequence(PseudoTime<Dim> time) : time_(std::move(time)) {}
  const PseudoTime<Dim>& update(std::span<const double>) override { return time_; }

 private:
  PseudoTime<Dim> time_;
};

/// Height of each part element's centre along `direction` (any length; empty: the plate's normal, pointing
/// away from it), 0 at the lowest and 1 at the highest corner of the part's elements. Collective.
template <int Dim>
PseudoTime<Dim> planar_time(const Part<Dim>& part, std::vector<double> direction);

/// Height of the part along `direction`, length unit. Collective.
template <int Dim>
double planar_height(const Part<Dim>& part, std::vector<double> direction);

/// Element-wise pseudo-time read from an HDF5 dataset [z][y][x], without gradient. Throws InputError if the
/// file does not fit the grid or a part element's value is outside [0, 1]. Collective.
template <int Dim>
PseudoTime<Dim> time_from_file(const Part<Dim>& part, const std::string& file, const std::string& dataset);

/// Part elements without a face on plate or substrate of which no face neighbour in the part comes earlier:
/// places where a layer would begin in the air. All ranks; collective.
template <int Dim>
std::int64_t count_interior_minima(const Part<Dim>& part, std::span<const double> time);

}  // namespace fabseq
