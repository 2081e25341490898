// SPDX-License-Identifier: MIT
/// \file
/// What a sequence and the planar baseline do under a change of what they were made for (docs/formulation.md
/// 12).
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/config/setup.h"
#include "fabseq/sequence/sequence.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Relative size of a change of a number, and standard deviation of the noise.
constexpr double size_of_change = 0.1;

/// A sequence, wherever it comes from.
template <int Dim>
struct GivenDesign {
  PseudoTime<Dim> time;
  std::vector<double> layer_variables;  ///< time points, where they vary, or angles
  double beta = 0.0;                    ///< sharpness of its smooth layers
};

/// A change.
struct Variation {
  std::string name;
  std::function<void(Config&)> change;  ///< what it does to the config's settings
  bool smooth = false;                  ///< of the sequence; the planar baseline stays binary
  bool finer = false;                   ///< the grid has twice as many elements along each axis
  int layers_times = 1;                 ///< both sequences have so many times as many layers
};

/// What distorts, in numbers. The same on all ranks.
struct VariedNumbers {
  std::vector<std::optional<double>> distortions;  ///< J of each distortion term of the objective
  std::optional<double> largest;                   ///< displacement of the part's nodes, length unit
  double rms = 0.0;                                ///< the same
  std::optional<double> largest_deviation = std::nullopt, rms_deviation = std::nullopt;  ///< of noise
};
/// Results for one changed problem, and for the unchanged one under the other deposition model and under
/// noise of the layers' strain, which need no solve.
struct Varied {
  VariedNumbers own;
  std::optional<VariedNumbers> other_deposition, noise;
};
struct VariedPair {
  Varied sequence, planar;
};

/// All changes that take a simulation, "unchanged" first. Collective on the world of the setup.
template <int Dim>
std::vector<Variation> all_variations(const Setup<Dim>& setup);

/// The layers as they are simulated, and cut into the real ones that they stand for, on one grid: twice as
/// fine where a bead is lower than an element, of which it has `per_bead`, unless that is not possible.
/// Collective on the world of the setup.
template <int Dim>
std::array<Variation, 2> variations_of_passes(const Setup<Dim>& setup, double per_bead);

/// Why a grid twice as fine is left out; empty: it is not. Collective on the world of the setup.
template <int Dim>
std::string obstacle_of_finer_grid(const Setup<Dim>& setup);

/// Simulates both under a change; with `more`, fills in what needs no solve. Collective on the world of the
/// setup. Throws InputError if the changed model is refused, NumericalError if a solve fails.
template <int Dim>
VariedPair simulate_varied(const Setup<Dim>& setup, const GivenDesign<Dim>& given, const Variation& variation,
                           bool more, PhaseTimer& timer);

}  // namespace fabseq
