// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/solve/solve_report.h"
#include "fabseq/solve/solve_tolerance.h"

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace fabseq {

/// What the process simulation asks of a solver: the elastic systems of blocks of layers, which share
/// elements, supports and element matrix.
template <int Dim>
class ElasticitySolver {
 public:
  virtual ~ElasticitySolver() = default;

  /// Makes the systems of layers first .. first + lanes - 1 the current ones. `stiffness` is [element][lane],
  /// the factor of the unit element stiffness; `changed` is false if these layers had the very same stiffness
  /// when they were last set. Collective.
  virtual void set_operators(int first_layer, int lanes, std::span<const double> stiffness, bool changed) = 0;

  /// Solves every lane of the current block for each of several sets of loads; values at supports are
  /// ignored. Returns one report per set and lane, [set][lane]. Collective; does not throw if a lane does not
  /// converge.
  virtual std::vector<std::vector<SolveReport>> solve(std::span<const LaneVector> loads,
                                                      std::span<LaneVector> displacements) = 0;
  /// The same from first guesses, which `displacements` hold; 0 in a lane: none. A solver may do without.
  virtual std::vector<std::vector<SolveReport>> improve(std::span<const LaneVector> loads,
                                                        std::span<LaneVector> displacements) {
    return solve(loads, displacements);
  }

  /// The number of sets of loads of the current block that a call makes the most of: further ones would only
  /// wait and take memory. The same on all ranks.
  virtual std::size_t sets_at_once() const { return std::numeric_limits<std::size_t>::max(); }

  /// Later solves go to this tolerance; on the reference path collective.
  virtual void set_tolerance(const SolveTolerance& tolerance) = 0;

  /// Forgets what earlier solves have left for later ones: from here on everything goes as in a new solver,
  /// to the last bit. Collective.
  virtual void start_cold() = 0;

  /// Gives back what it can take again, its operator included. Changes no result. Not collective.
  virtual void release_memory() {}
  /// Whether it is to give back memory whenever other phases come before the next solve.
  virtual bool saves_memory() const { return false; }

  /// One line for the log: which solver it is, with how many unknowns.
  virtual std::string description() const = 0;
};

}  // namespace fabseq
