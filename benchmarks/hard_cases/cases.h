// SPDX-License-Identifier: MIT
/// \file
/// Parts and pseudo-times that make a multigrid's life hard.
#pragma once

#include "lane_case.h"
#include <string>
#include <vector>

namespace benchmarks {

struct HardCase {
  std::string name;
  std::string what;
  DrawnPart part;
};

/// All of them, easiest first. `scale` refines the grids; 0.5 halves the counts.
std::vector<HardCase> hard_cases(double scale);

}  // namespace benchmarks
