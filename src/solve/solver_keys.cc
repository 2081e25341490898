// SPDX-License-Identifier: MIT
#include "fabseq/keys/section.h"
#include "fabseq/solve/solver_settings.h"

namespace fabseq {

Section<SolverSettings> solver_keys() {
  using Its = SolverSettings;
  return Section<Its>("solver", "Linear solver")
      .key("tolerance", &Its::tolerance, "Preconditioned residual of every solve; auto: from 1e-2 to 1e-6",
           {.range = "(0, 1)", .words = "auto", .option = "-tolerance"})
      .key("path", &Its::path, "Eight layers at once (lanes), or PETSc's solvers, one at a time (reference)",
           {.words = "lanes reference", .option = "-solver_path"})
      .key("cycle", &Its::cycle,
           "Multigrid cycle of the lanes: conjugate gradients on coarse levels (k), several visits (w) or "
           "one (v)",
           {.words = "k w v", .option = "-solver_cycle"})
      .key("smoother_degree", &Its::smoother_degree, "Degree of the lanes' smoother",
           {.range = "[1, 8]", .option = "-smoother_degree"})
      .key("reference_method", &Its::method, "Preconditioner of the reference path",
           {.words = "auto gamg multigrid direct", .option = "-reference_method"})
      .key("region", &Its::region,
           "Elements of the systems, in iterations and evaluations: all (whole), or those built by then; "
           "auto: built in iterations where that saves time",
           {.words = "auto whole built", .option = "-solver_region"})
      .key("layer_groups", &Its::layer_groups,
           "Groups of ranks that share the layers; a divisor of the number of ranks",
           {.range = "[1, inf)", .words = "auto", .option = "-layer_groups"})
      .key("lanes", &Its::lanes,
           "Layers solved side by side; fewer take less memory; auto: as many as memory holds",
           {.range = "[1, 8]", .words = "auto", .option = "-lanes"});
}

}  // namespace fabseq
