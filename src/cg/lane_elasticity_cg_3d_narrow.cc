// SPDX-License-Identifier: MIT
#include "cg/lane_cg_impl.h"

namespace fabseq {

// Apart from the widest one: each takes a minute to compile.
template class LaneCg<LaneElasticityProblem<3>, 4>;
template class LaneCg<LaneElasticityProblem<3>, 2>;
template class LaneCg<LaneElasticityProblem<3>, 1>;

}  // namespace fabseq
