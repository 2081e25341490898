// SPDX-License-Identifier: MIT
/// \file
/// Multilinear interpolation between nested box grids, restricted to the unknowns of a model.
#pragma once

#include "fabseq/base/petsc.h"
#include "fabseq/grid/unknown_numbering.h"

#include <string>
#include <vector>

namespace fabseq {

/// Interpolation matrices for PCMG, finest first: entry l maps unknowns of level l + 1 (twice as coarse) to
/// those of level l. Coarsening goes on while every axis has an even element count, every process keeps a
/// node along every axis, and more than `coarsest` unknown nodes remain. A coarse node is an unknown if it
/// interpolates to an unknown of the finer level. Collective. Empty if the grid cannot be coarsened.
template <int Dim>
std::vector<MatHandle> make_interpolations(const UnknownNumbering<Dim>& numbering, std::int64_t coarsest);

/// Why a grid cannot be coarsened even once, in words; empty if it can. Collective.
template <int Dim>
std::string coarsening_obstacle(const Grid<Dim>& grid);

}  // namespace fabseq
