// SPDX-License-Identifier: MIT
#include "cg/lane_cg_impl.h"

namespace fabseq {

FABSEQ_EACH_LANE_CG(template, LaneHeatProblem<2>);
FABSEQ_EACH_LANE_CG(template, LaneHeatProblem<3>);

}  // namespace fabseq
