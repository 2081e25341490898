// SPDX-License-Identifier: MIT
/// \file
/// What the adjoint of the process starts from and where it leads.
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/layers/density_sink.h"
#include "fabseq/process/process_result.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// The derivative of a functional with respect to the displacements of a combination of strain cases.
struct ProcessAdjoint {
  std::vector<double> displacement;      ///< dJ/du, [owned node][component]; empty: zero
  std::vector<LaneVector> increments;    ///< dJ/d(counted increment) on top, like ProcessResult; empty: zero
  std::vector<double> release;           ///< dJ/dv, [owned node][component]; empty: zero
  std::vector<double> combination = {};  ///< factor of each case in u; empty: the first case alone

  /// Local: ranks without nodes have nothing either way.
  bool is_zero() const { return displacement.empty() && increments.empty() && release.empty(); }
};

/// dJ/dw_j = (dJ/du + dJ/d(counted du_j)) . du_j at the nodes of a block of layers, for its increments of the
/// functional's combination. Not collective.
LaneVector weight_derivatives(const ProcessAdjoint& functional, const ProcessResult& result,
                              std::size_t block, const LaneVector& increments);

/// Where the derivatives of a functional with respect to densities, strains and temperatures go.
struct ProcessDerivatives {
  DensityDerivatives* densities = nullptr;
  std::vector<double>* strains = nullptr;  ///< dJ/d(inputs of the StrainSource), sized at first
                                           ///< use; nullptr: not asked for
  /// dJ/d(StepTemperatures), this rank's part of the sum over its copies, sized at first use; nullptr: not
  /// asked for.
  std::vector<std::vector<double>>* temperatures = nullptr;
  DensitySink* sink = nullptr;  ///< takes `densities` after each block of layers; nullptr: they stay there
};

}  // namespace fabseq
