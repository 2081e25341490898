#include "fabseq/solve/lane_cg_impl.h"

namespace fabseq {

template class LaneCg<LaneElasticityProblem<3>, 8>;
template class LaneCg<LaneElasticityProblem<3>, 4>;
template class LaneCg<LaneElasticityProblem<3>, 2>;
template class LaneCg<LaneElasticityProblem<3>, 1>;

}  // namespace fabseq
