// SPDX-License-Identifier: MIT
/// \file
/// What the machine can do: the limits that the kernels are compared with.
#pragma once

namespace benchmarks {

/// Of one core, while all ranks measure at once.
struct MachineLimits {
  double triad = 0.0;  ///< bytes a second
  double fma = 0.0;    ///< flops a second
};

/// Best of a few passes, about half a second. Collective on the world.
MachineLimits measure_limits();

}  // namespace benchmarks
