/// \file
/// All variables of a problem together.
#pragma once

#include <vector>

namespace fabseq {

/// A point in the space of design variables, or a derivative by them.
struct Design {
  std::vector<double> field;  ///< of the sequence: this rank's share (LayerGroups::share)
  std::vector<double>
      time_points;  ///< T_1 ... T_{N-1} where they are variables, else empty; the same on all ranks
};

}  // namespace fabseq
