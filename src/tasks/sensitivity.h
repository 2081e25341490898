// SPDX-License-Identifier: MIT
/// \file
/// How far a sequence can be trusted: what it does under stated changes, each beside the planar baseline
/// under the same change.
#pragma once

#include "fabseq/chain/design.h"
#include "fabseq/files/output_directory.h"
#include "tasks/variation.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A change, and what both sequences do under it.
struct SensitivityRow {
  std::string change;
  std::string skipped;  ///< why there are no numbers; empty: there are
  VariedNumbers sequence, planar;
  int layers_times = 1;  ///< both sequences have so many times as many layers

  /// Planar length sqrt(J) over that of the sequence, for the first distortion term; none without one.
  std::optional<double> length_ratio() const;
  /// Planar rms of the part's displacement over that of the sequence.
  std::optional<double> rms_ratio() const;
};

/// The table, the same on all ranks. Nothing here is collective.
struct SensitivityTable {
  std::string name;                ///< of the config
  std::vector<std::string> terms;  ///< names of the distortion terms, objective_0, ...
  std::vector<SensitivityRow> rows;

  using Ratio = std::optional<double> (SensitivityRow::*)() const;
  /// The row with the smallest ratio; nullptr if there is none.
  const SensitivityRow* worst(Ratio ratio) const;
  /// What the ratio tends to with ever thinner layers, extrapolated from twice and four times as many with an
  /// error that halves with the thickness; none without these rows or where the ratio does not settle.
  std::optional<double> thin_layers(Ratio ratio) const;
  Json json() const;
  std::string csv() const;
  /// Lines for the terminal.
  std::vector<std::string> text() const;
};

/// Simulates all changes of a design, and writes sensitivity.json and .csv to the directory and the table to
/// the terminal. `beta`: sharpness of its smooth layers. A change whose model is refused or whose
/// solves fail has a row that says why. Collective on the world of the setup; throws Stopped between changes.
template <int Dim>
void write_sensitivity(const Setup<Dim>& setup, Sequence<Dim>& sequence, const Design& design, double beta,
                       const OutputDirectory& directory, PhaseTimer& timer);

}  // namespace fabseq
