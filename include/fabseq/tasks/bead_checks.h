// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/config/setup.h"
#include "fabseq/report/sequence_report.h"

#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// Real layers, on a grid of BeadChecks.
template <int Dim>
struct RealSequence {
  PseudoTime<Dim> time;
  std::vector<double> layer;      ///< of each part element, from 1
  int count = 0;                  ///< of real layers
  SubParts sub_parts;             ///< of multi-planar layers
  std::vector<double> variables;  ///< of its layers
  BuildReport build;              ///< their checks
};

/// Judges sequences whose simulated layers stand for several real ones by these: the pseudo-time is carried
/// to a grid with enough elements to a bead, and each layer cut into `layers.passes` equal steps of it
/// (docs/formulation.md 13.1).
template <int Dim>
class BeadChecks {
 public:
  /// Makes the grids; the setup must outlive it. Collective. Throws InputError where not even a grid twice as
  /// fine can be made.
  explicit BeadChecks(const Setup<Dim>& setup);

  /// The setup in real layers on the coarsest grid with an element to a bead, on which bodies of layers can
  /// still be made.
  const Setup<Dim>& for_bodies() const;
  /// Puts checks, places and verdict of the real layers of a design, on the finest grid, in place of those of
  /// its simulated layers, whose variables are given. Returns these real layers.
  RealSequence<Dim> judge(const PseudoTime<Dim>& time, std::span<const double> variables,
                          SequenceReport& report) const;
  /// The same of so many simulated layers of equal steps.
  void judge(const PseudoTime<Dim>& time, int layers, SequenceReport& report) const;
  /// The real layers of a design that has been judged by those, on the grid for bodies.
  RealSequence<Dim> on_grid_for_bodies(RealSequence<Dim> judged, const PseudoTime<Dim>& time,
                                       std::span<const double> variables) const;

 private:
  const Setup<Dim>& finest() const { return grids_.back()->setup; }
  RealSequence<Dim> cut(const PseudoTime<Dim>& time, std::span<const double> variables,
                        const Setup<Dim>& on) const;
  void replace(const RealSequence<Dim>& real, SequenceReport& report) const;
  /// Cuts with curved layers of these time points, or else by `layers`.
  RealSequence<Dim> checked(const PseudoTime<Dim>& time, const Layers& layers,
                            std::vector<double> time_points, const Setup<Dim>& on) const;

  struct Level {
    Level(MPI_Comm world, Config config_) : config(std::move(config_)), setup(world, config) {}
    const Config config;
    const Setup<Dim> setup;
    double per_bead = 0.0;  ///< elements to a bead
  };

  const Setup<Dim>& simulated_;
  std::vector<std::unique_ptr<Level>> grids_;  ///< each twice as fine as the one before
  bool is_finer_ = true;                       ///< whether the first is finer than that of the setup
};

/// None where each simulated layer is a real one, in runs with which others begin, or, with a warning, where
/// the grids cannot be made. Collective.
template <int Dim>
std::unique_ptr<const BeadChecks<Dim>> make_bead_checks(const Setup<Dim>& setup);

}  // namespace fabseq
