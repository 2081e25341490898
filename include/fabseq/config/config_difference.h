// SPDX-License-Identifier: MIT
/// \file
/// Whether two configs pose the same problem.
#pragma once

#include "fabseq/base/json.h"

#include <string>

namespace fabseq {

/// The first key in which two effective configs differ, with both values ("/layers/count was 4, is 5 now");
/// "" if they pose the same problem. Keys that a continued run may change do not count: name, output, run,
/// solver, the place of a voxel or mesh file, the name of the unit, and the optimizer's numbers of
/// iterations, tolerances and window. Not collective.
std::string config_difference(const Json& then, const Json& now);

}  // namespace fabseq
