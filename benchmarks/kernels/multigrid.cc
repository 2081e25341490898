// SPDX-License-Identifier: MIT
#include "fabseq/lanes/band_cholesky.h"
#include "fabseq/lanes/flush_to_zero.h"
#include "fabseq/lanes/lane_multigrid_impl.h"

#include "kernels/groups.h"
#include "kernels/kernel_cost.h"
#include "lane_case.h"
#include <functional>

namespace benchmarks {

namespace {

/// Of the multigrid in the program.
using Real = float;
using Vector = fabseq::LaneValues<Real>;
constexpr double word = sizeof(Real);
using Problem = LaneCase::Problem;
constexpr int lanes = LaneCase::lanes;
using Operator = fabseq::LaneOperator<Problem, lanes, Real>;

/// A box with its finest operator set up, and a few vectors.
struct Box {
  explicit Box(int elements)
      : part(MPI_COMM_SELF, drawn_box(elements)),
        level(part.hierarchy().level(0)),
        matrix(level, part.problem()),
        right(matrix.size()),
        solution(right.size()),
        extra(right.size()),
        cost(operator_cost<Problem, lanes, Real>(level.mesh)) {
    fabseq::LaneArray exact(matrix.coefficients().size());
    part.fill(exact);
    matrix.coefficients().assign(exact.begin(), exact.end());
    const fabseq::LaneArray load = part.load();
    right.assign(load.begin(), load.end());
    matrix.set_up();
    matrix.smooth(right.data(), solution.data(), extra.data(), 2, true);
  }

  fabseq::FlushToZero flush_to_zero;  ///< as in LaneCg
  LaneCase part;
  fabseq::LaneLevel<3>& level;
  Operator matrix;
  Vector right, solution, extra;
  Cost cost;  ///< of K x
};

/// The operator with further words and flops an unknown. K x itself reads x and writes a vector.
Cost with(Cost cost, double words, double flops) {
  cost.bytes += words * word * cost.unknowns;
  cost.flops += flops * cost.unknowns;
  return cost;
}

/// Inverse node blocks: six numbers for three unknowns, five flops an unknown.
constexpr double block_words = 2.0;
constexpr double block_flops_an_unknown = 5.0;
/// Step from zero: reads b and the blocks, writes x.
constexpr double first_words = 2.0 + block_words;
constexpr double first_flops = block_flops_an_unknown + 1.0;
/// Another step: reads b and the blocks beside what K x moves; difference, blocks, scale and addition.
constexpr double step_words = 1.0 + block_words;
constexpr double step_flops = 3.0 + block_flops_an_unknown;

void add_smoothers(int elements) {
  add("smoother/one_step", 12, [=](benchmark::State& state) {
    Box box(elements);
    measure(state, with(box.cost, step_words, step_flops),
            [&] { box.matrix.smooth(box.right.data(), box.solution.data(), box.extra.data(), 1, false); });
  });
  // Before the coarse correction: the old step is x itself, which is there.
  add("smoother/degree_2_from_zero", 12, [=](benchmark::State& state) {
    Box box(elements);
    measure(state, with(box.cost, first_words + step_words, first_flops + step_flops + 2.0),
            [&] { box.matrix.smooth(box.right.data(), box.solution.data(), box.extra.data(), 2, true); });
  });
  // After it: two sweeps; the step is written by the first and read by the second.
  add("smoother/degree_2", 8, [=](benchmark::State& state) {
    Box box(elements);
    Cost cost = with(box.cost, 2.0 * step_words + 2.0, 2.0 * step_flops + 2.0);
    cost.bytes += box.cost.bytes;
    cost.flops += box.cost.flops;
    measure(state, cost,
            [&] { box.matrix.smooth(box.right.data(), box.solution.data(), box.extra.data(), 2, false); });
  });
}

void add_residual(int elements) {
  // K x and x . K x; the product can be had in passing.
  add("operator/single_precision", 12, [=](benchmark::State& state) {
    Box box(elements);
    measure(state, with(box.cost, 0.0, 2.0),
            [&] { benchmark::DoNotOptimize(box.matrix.apply(box.solution.data(), box.extra.data())[0]); });
  });
  add("residual", 12, [=](benchmark::State& state) {
    Box box(elements);
    measure(state, with(box.cost, 1.0, 1.0),
            [&] { box.matrix.residual_part(box.right.data(), box.solution.data(), box.extra.data()); });
  });
}

/// Flops are few and not counted.
void add_transfers(int elements) {
  const auto sizes = [](const Box& box, const Vector& coarse, double fine_words, double coarse_words) {
    const auto unknowns = static_cast<double>(box.solution.size());
    return Cost{.unknowns = unknowns,
                .bytes = word * (fine_words * unknowns + coarse_words * static_cast<double>(coarse.size()))};
  };
  const auto coarse_vector = [](Box& box) {
    return Vector(static_cast<std::size_t>(box.part.hierarchy().level(1).mesh.nodes()) * 3 * lanes,
                  Real{1e-9});
  };
  add("transfer/prolong", 20, [=](benchmark::State& state) {
    Box box(elements);
    const Vector coarse = coarse_vector(box);
    measure(state, sizes(box, coarse, 2.0, 1.0),
            [&] { box.level.transfer.prolong_add<3, lanes>(coarse.data(), box.solution.data()); });
  });
  add("transfer/restrict", 20, [=](benchmark::State& state) {
    Box box(elements);
    Vector coarse = coarse_vector(box);
    measure(state, sizes(box, coarse, 1.0, 2.0),
            [&] { box.level.transfer.restrict_add<3, lanes>(box.right.data(), coarse.data()); });
  });
}

/// The last level of 80 x 40 x 80 elements by itself: a hierarchy of one level solves directly. The factor of
/// every lane passes twice.
void add_coarse_solve() {
  add("coarse/solve", 40, [](benchmark::State& state) {
    LaneCase part(MPI_COMM_SELF, drawn_v_shape(10, first_sharpness));
    fabseq::LaneMultigrid<Problem, lanes, Real> multigrid(part.hierarchy(), part.problem(), {});
    fabseq::LaneArray exact(multigrid.finest().coefficients().size());
    part.fill(exact);
    multigrid.finest().coefficients().assign(exact.begin(), exact.end());
    multigrid.set_up();
    const fabseq::LaneArray load = part.load();
    const Vector right(load.begin(), load.end());
    Vector solution(right.size());
    const fabseq::BandNumbering<3> numbering(part.hierarchy().level(0).mesh, 3);
    const auto unknowns = static_cast<double>(right.size());
    const double band = unknowns * (numbering.bandwidth() + 1);
    measure(state, {unknowns, 2.0 * sizeof(double) * band, 4.0 * band},
            [&] { multigrid.apply(right.data(), solution.data()); });
  });
}

}  // namespace

void add_multigrid(int elements) {
  add_residual(elements);
  add_smoothers(elements);
  add_transfers(elements);
  add_coarse_solve();
}

}  // namespace benchmarks
