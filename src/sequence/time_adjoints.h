// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/solve/heat_solver.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Solves K lambda = dJ/dt_n for rows of derivatives with respect to the element means of nodal times and to
/// their gradients at centres, as many rows side by side as `lanes` and PETSc's indices allow.
/// \param use   gets lambda of each of these blocks of rows, in order
/// \param what  the solve, for the message of one that does not converge
/// Returns the iterations of each row. Collective on the grid's communicator.
template <int Dim>
std::vector<int> solve_time_adjoints(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                                     HeatSolver<Dim>& solver, std::span<const TimeDerivatives> rows,
                                     int lanes, const std::function<void(const LaneVector& adjoints)>& use,
                                     const std::string& what);

}  // namespace fabseq
