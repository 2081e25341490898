// SPDX-License-Identifier: MIT
/// \file
/// The groups of benchmarks, a source each.
#pragma once

namespace benchmarks {

/// Triad and multiply-adds of a core.
void add_machine();
/// K x alone, on full boxes with `elements` along the longer edges.
void add_operators(int elements);
/// Parts of the preconditioner on a full box.
void add_multigrid(int elements);
/// Set-up and solve of eight layers of the V-shape.
void add_solve(int elements);

}  // namespace benchmarks
