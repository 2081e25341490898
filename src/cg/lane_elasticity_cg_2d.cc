// SPDX-License-Identifier: MIT
#include "cg/lane_cg_impl.h"

namespace fabseq {

FABSEQ_EACH_LANE_CG(template, LaneElasticityProblem<2>);

}  // namespace fabseq
