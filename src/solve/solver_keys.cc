// SPDX-License-Identifier: MIT
#include "fabseq/keys/section.h"
#include "fabseq/solve/solver_settings.h"

namespace fabseq {

Section<SolverSettings> solver_keys() {
  using Its = SolverSettings;
  return Section<Its>("solver", "Linear solver")
      .key("tolerance", &Its::tolerance,
           "Preconditioned residual of every solve, relative to a zero start; "
           "auto: an optimization begins coarsely and ends with 1e-6",
           {.range = "(0, 1)", .words = "auto", .option = "-tolerance"})
      .key("path", &Its::path,
           "Solver: all layers of a batch at once (lanes), "
           "or PETSc's own parts, one layer at a time (reference)",
           {.words = "lanes reference", .option = "-solver_path"})
      .key("cycle", &Its::cycle,
           "Multigrid cycle of the lanes: conjugate gradients on the coarse levels (k), "
           "several visits (w: fewer reductions, for many ranks) or one (v)",
           {.words = "k w v", .option = "-solver_cycle"})
      .key("smoother_degree", &Its::smoother_degree,
           "Degree of the lanes' Chebyshev smoother, before and after",
           {.range = "[1, 8]", .option = "-smoother_degree"})
      .key("reference_method", &Its::method, "Preconditioner of the reference path",
           {.words = "auto gamg multigrid direct", .option = "-reference_method"})
      .key(
          "layer_groups", &Its::layer_groups,
          "Groups of ranks that share the layers, each with the whole box; a divisor of the number of ranks; "
          "auto: by ranks, layers and memory",
          {.range = "[1, inf)", .words = "auto", .option = "-layer_groups"})
      .key("lanes", &Its::lanes,
           "Layers solved side by side at most. Fewer than 8 take less memory and more time; "
           "auto: 8, or as many as the memory holds",
           {.range = "[1, 8]", .words = "auto", .option = "-lanes"});
}

}  // namespace fabseq
