// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace fabseq {

/// Temperatures of the elements at the end of each step of a process, degrees Celsius.
struct StepTemperatures {
  std::vector<std::vector<double>> elements;  ///< [step][element of the elastic model]
  double plate = 0.0;                         ///< that of the substrate before the first step
};

}  // namespace fabseq
