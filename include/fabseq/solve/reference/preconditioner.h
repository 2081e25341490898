// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/petsc.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/solve/solver_settings.h"

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

/// The method to use. `automatic` stands for a factorization for small systems, geometric multigrid where the
/// grid can be coarsened far enough, else GAMG; `multigrid` becomes GAMG where the grid cannot be coarsened
/// (coarsening_obstacle()), and a factorization where it is as small as a coarsest level. Collective.
template <int Dim>
ReferenceMethod usable_method(ReferenceMethod wanted, const UnknownNumbering<Dim>& numbering);

/// Makes `solver`, whose operator is `matrix` and whose options prefix is set, use `method` (one that
/// usable_method() gave). `safe`: slower, but positive definite in layers in which the fast settings are not.
/// The user's options come on top, by KSPSetFromOptions. Collective.
template <int Dim>
void set_up_preconditioner(KSP solver, Mat matrix, const UnknownNumbering<Dim>& numbering,
                           ReferenceMethod method, bool safe);

/// Refuses values of PETSc's options for the solvers with these prefixes that PETSc refuses, before there are
/// any systems. Throws InputError. Collective on PETSC_COMM_WORLD.
void require_solver_options(const std::vector<std::string>& prefixes);

}  // namespace fabseq
