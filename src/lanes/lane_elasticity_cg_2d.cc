// SPDX-License-Identifier: MIT
#include "fabseq/lanes/lane_cg_impl.h"

namespace fabseq {

template class LaneCg<LaneElasticityProblem<2>, 8>;
template class LaneCg<LaneElasticityProblem<2>, 4>;
template class LaneCg<LaneElasticityProblem<2>, 2>;
template class LaneCg<LaneElasticityProblem<2>, 1>;

}  // namespace fabseq
