// SPDX-License-Identifier: MIT
#include "cg/lane_cg_impl.h"

namespace fabseq {

template class LaneCg<LaneElasticityProblem<3>, 8>;

}  // namespace fabseq
