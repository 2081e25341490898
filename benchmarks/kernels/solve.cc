// SPDX-License-Identifier: MIT
#include "kernels/measure.h"
#include "lane_case.h"

#include <algorithm>

namespace benchmarks {

namespace {

using fabseq::LaneArray;
constexpr int lanes = LaneCase::lanes;

double unknowns_of(LaneSystem& system) { return static_cast<double>(system.solver.matrix().size()); }

/// dof/s: unknowns of the finest level by the time of the whole set-up or solve. Bytes and flops depend on
/// the iterations of each lane and are not counted.
void measure_solve(benchmark::State& state, int elements, double sharpness) {
  LaneSystem system(MPI_COMM_SELF, drawn_v_shape(elements, sharpness));
  system.solver.set_up();
  const LaneArray load = system.lane_case.load();
  LaneArray right, solution;
  double iterations = 0.0;
  const double seconds = measure(state, {.unknowns = unknowns_of(system)}, [&] {
    right = load;  // the solver overwrites it
    const fabseq::LaneStop stop{1e-5, 200};
    for (const auto& outcome : system.solver.solve(right, solution, lanes, stop)) {
      iterations = std::max(iterations, static_cast<double>(outcome.iterations));
      if (!outcome.converged) state.SkipWithError("a lane did not converge");
    }
  });
  state.counters["seconds_a_lane"] = seconds / lanes;
  state.counters["iterations"] = iterations;
}

}  // namespace

void add_solve(int elements) {
  add("set_up/v_shape", 4, [=](benchmark::State& state) {
    LaneSystem system(MPI_COMM_SELF, drawn_v_shape(elements, first_sharpness));
    const double seconds = measure(state, {.unknowns = unknowns_of(system)}, [&] { system.solver.set_up(); });
    state.counters["seconds_a_lane"] = seconds / lanes;
  });
  for (const auto& [name, sharpness] : {std::pair{"first", first_sharpness}, {"last", last_sharpness}})
    add("solve/v_shape/" + std::string(name) + "_sharpness", 1,
        [=, sharpness = sharpness](benchmark::State& state) { measure_solve(state, elements, sharpness); });
}

}  // namespace benchmarks
