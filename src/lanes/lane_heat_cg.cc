// SPDX-License-Identifier: MIT
#include "fabseq/lanes/lane_cg_impl.h"

namespace fabseq {

template class LaneCg<LaneHeatProblem<2>, 8>;
template class LaneCg<LaneHeatProblem<2>, 4>;
template class LaneCg<LaneHeatProblem<2>, 2>;
template class LaneCg<LaneHeatProblem<2>, 1>;
template class LaneCg<LaneHeatProblem<3>, 8>;
template class LaneCg<LaneHeatProblem<3>, 4>;
template class LaneCg<LaneHeatProblem<3>, 2>;
template class LaneCg<LaneHeatProblem<3>, 1>;

}  // namespace fabseq
