// SPDX-License-Identifier: MIT
#include "fabseq/lanes/lane_cg_impl.h"

namespace fabseq {

FABSEQ_EACH_LANE_CG(template, LaneElasticityProblem<2>);

}  // namespace fabseq
