// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/sequence/sequence.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// Settings of a planar sequence (docs/formulation.md 3.3).
struct PlanarSettings {
  std::vector<double> direction;  ///< build direction; empty: the plate's normal
};

/// Settings of a sequence from a file (docs/formulation.md 3.1).
struct FileSettings {
  std::string file;              ///< absolute path of an HDF5 file
  std::string dataset = "time";  ///< its dataset, axes [z][y][x]
};

/// A sequence without design variables (docs/formulation.md 3.3, 3.1): its pseudo-time never changes.
template <int Dim>
class GivenSequence : public Sequence<Dim> {
 public:
  explicit GivenSequence(PseudoTime<Dim> time) : time_(std::move(time)) {}
  const PseudoTime<Dim>& update(std::span<const double>) override { return time_; }

 private:
  PseudoTime<Dim> time_;
};

/// Planar pseudo-time: the height of each part element's centre along `direction`, scaled to 0 at the lowest
/// and 1 at the highest corner of all part elements. `direction` may have any length; empty: the plate's
/// normal, pointing away from the plate. Collective on the grid's communicator.
template <int Dim>
PseudoTime<Dim> planar_time(const Part<Dim>& part, std::vector<double> direction);

/// Height of the part along `direction` (as in planar_time()), length unit. Collective on the grid's
/// communicator.
template <int Dim>
double planar_height(const Part<Dim>& part, std::vector<double> direction);

/// Element-wise pseudo-time from an HDF5 dataset [z][y][x], such as "time". A dataset beside it,
/// "time_gradient" [z][y][x][axis] in 1/length, becomes PseudoTime::recorded_gradient, and "nodal_time" of
/// the nodes, or what a "temperature" means, PseudoTime::nodal. Collective on the grid's communicator. Throws
/// InputError if the file does not fit the grid, or if the value of a part element is no number or, without a
/// gradient beside it, more than a little beyond [0, 1].
template <int Dim>
PseudoTime<Dim> time_from_file(const Part<Dim>& part, const std::string& file, const std::string& dataset);

}  // namespace fabseq
