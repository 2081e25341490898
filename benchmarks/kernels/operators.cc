// SPDX-License-Identifier: MIT
#include "fabseq/grid/grid.h"
#include "kernels/lane_array.h"
#include "kernels/lane_sweep.h"
#include "kernels/measure.h"

#include <cmath>
#include <string>
#include <vector>

namespace benchmarks {

namespace {

using fabseq::Domain;
using fabseq::LaneArray;
using fabseq::Lanes;

/// Numbers without a pattern, around `mean`.
LaneArray wavy(std::size_t size, double mean) {
  LaneArray values(size);
  for (std::size_t i = 0; i < size; ++i) values[i] = mean + 0.5 * std::sin(0.37 * static_cast<double>(i));
  return values;
}

template <class Problem, int Width>
void sweep_box(benchmark::State& state, const Domain<Problem::dim>& domain, const Problem& problem) {
  constexpr int components = Problem::components;
  const fabseq::IndexBox<Problem::dim> box{{}, domain.elements};
  const std::vector<char> active(static_cast<std::size_t>(box.count()), 1);
  const fabseq::LaneMesh<Problem::dim> mesh(box, active);
  fabseq::Point<Problem::dim> spacing;
  for (int axis = 0; axis < Problem::dim; ++axis) spacing[axis] = domain.size[axis] / domain.elements[axis];
  const auto matrices = problem.matrices(spacing);

  using Kernel = typename Problem::template Kernel<Width>;
  const std::size_t size = static_cast<std::size_t>(mesh.nodes()) * components * Width;
  const LaneArray coefficients = wavy(static_cast<std::size_t>(mesh.elements()) * Kernel::stride, 1.0);
  const LaneArray x = wavy(size, 0.0);
  LaneArray y(size), window(static_cast<std::size_t>(mesh.window()) * components * Width);
  const Kernel kernel = Problem::template kernel<Width>(matrices, coefficients.data());

  const MachineLimits machine = measure_limits();
  const Cost cost = operator_cost<Problem, Width>(mesh);
  const double seconds = measure(state, cost, [&] {
    sweep(mesh, kernel, x.data(), window.data(), static_cast<double*>(nullptr),
          [&]<class Sum>(std::int64_t node, const std::array<Sum, components>& sums) {
            for (int a = 0; a < components; ++a) {
              double* const place = y.data() + (node * components + a) * Width;
              if constexpr (Sum::width == Width)
                sums[a].stream(place);
              else
                sums[a].store(place);
            }
          });
  });
  const Cost most = limiting_cost<Problem>(cost);
  const double limit = std::min(machine.triad / most.bytes, machine.fma / most.flops);
  state.counters["percent_of_limit"] = 100.0 * cost.unknowns / seconds / limit;
}

template <class Problem, int... Widths>
void add_sweeps(const std::string& name, const Domain<Problem::dim>& domain, const Problem& problem) {
  (add("operator/" + name + "/lanes:" + std::to_string(Widths), 160 / Widths,
       [=](benchmark::State& state) { sweep_box<Problem, Widths>(state, domain, problem); }),
   ...);
}

}  // namespace

void add_operators(int elements) {
  const Domain<3> solid{{2.0, 1.0, 2.0}, {elements, elements / 2, elements}};
  const Domain<2> sheet{{2.0, 1.0}, {10 * elements, 5 * elements}};
  add_sweeps<fabseq::LaneElasticityProblem<3>, 8, 4, 2, 1>("elasticity_3d", solid, {1.0, 0.3});
  add_sweeps<fabseq::LaneElasticityProblem<2>, 8>("elasticity_2d", sheet, {1.0, 0.3});
  add_sweeps<fabseq::LaneHeatProblem<3>, 8>("heat_3d", solid, {1.0, false});
}

}  // namespace benchmarks
