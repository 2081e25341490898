// SPDX-License-Identifier: MIT
#include "kernels/flush_to_zero.h"
#include "kernels/measure.h"
#include "lane_case.h"
#include "multigrid/band_cholesky.h"
#include "multigrid/lane_multigrid_impl.h"

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
        coarse(static_cast<std::size_t>(part.hierarchy().level(1).mesh.nodes()) * 3 * lanes, Real{1e-9}),
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
  Vector right, solution, extra, coarse;
  Cost cost;  ///< of K x
};

/// Inverse node blocks: six numbers for three unknowns, five flops an unknown.
constexpr double block_words = 2.0;
constexpr double block_flops_an_unknown = 5.0;
/// Step from zero: reads b and the blocks, writes x.
constexpr double first_words = 2.0 + block_words;
constexpr double first_flops = block_flops_an_unknown + 1.0;
/// Another step: reads b and the blocks beside what K x moves; difference, blocks, scale and addition.
constexpr double step_words = 1.0 + block_words;
constexpr double step_flops = 3.0 + block_flops_an_unknown;

/// What a kernel takes: words and flops an unknown, beside those of K x, which reads x and writes a vector.
struct Work {
  double words = 0.0, flops = 0.0;
  double products = 1.0;      ///< how often K x is in it
  double coarse_words = 0.0;  ///< an unknown of the next level
};

template <class Call>
void add_on_box(const std::string& name, int calls, int elements, const Work& work, Call call) {
  add(name, calls, [=](benchmark::State& state) {
    Box box(elements);
    Cost cost = box.cost;
    const double moved =
        work.words * cost.unknowns + work.coarse_words * static_cast<double>(box.coarse.size());
    cost.bytes = work.products * cost.bytes + word * moved;
    cost.flops = work.products * cost.flops + work.flops * cost.unknowns;
    measure(state, cost, [&] { call(box); });
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
    const double band = unknowns * (numbering.bandwidth + 1);
    measure(state, {unknowns, 2.0 * word * band, 4.0 * band},
            [&] { multigrid.apply(right.data(), solution.data()); });
  });
}

}  // namespace

void add_multigrid(int elements) {
  // K x and x . K x; the product can be had in passing.
  add_on_box("operator/single_precision", 12, elements, {0.0, 2.0}, [](Box& box) {
    benchmark::DoNotOptimize(box.matrix.apply(box.solution.data(), box.extra.data())[0]);
  });
  add_on_box("residual", 12, elements, {1.0, 1.0}, [](Box& box) {
    box.matrix.residual_part(box.right.data(), box.solution.data(), box.extra.data());
  });

  const auto smooth = [](int degree, bool from_zero) {
    return [=](Box& box) {
      box.matrix.smooth(box.right.data(), box.solution.data(), box.extra.data(), degree, from_zero);
    };
  };
  add_on_box("smoother/one_step", 12, elements, {step_words, step_flops}, smooth(1, false));
  // Before the coarse correction: the old step is x itself, which is there.
  add_on_box("smoother/degree_2_from_zero", 12, elements,
             {first_words + step_words, first_flops + step_flops + 2.0}, smooth(2, true));
  // After it: two sweeps; the step is written by the first and read by the second.
  add_on_box("smoother/degree_2", 8, elements, {2.0 * step_words + 2.0, 2.0 * step_flops + 2.0, 2.0},
             smooth(2, false));

  // Flops of the transfers are few and not counted.
  add_on_box("transfer/prolong", 20, elements, {2.0, 0.0, 0.0, 1.0}, [](Box& box) {
    box.level.transfer.prolong_add<3, lanes>(box.coarse.data(), box.solution.data());
  });
  add_on_box("transfer/restrict", 20, elements, {1.0, 0.0, 0.0, 2.0}, [](Box& box) {
    box.level.transfer.restrict_add<3, lanes>(box.right.data(), box.coarse.data());
  });

  add_coarse_solve();
}

}  // namespace benchmarks
