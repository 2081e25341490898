// SPDX-License-Identifier: MIT
#include "fabseq/lanes/lane_cg_impl.h"

namespace fabseq {

template class LaneCg<LaneElasticityProblem<3>, 8>;

}  // namespace fabseq
