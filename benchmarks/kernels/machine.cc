// SPDX-License-Identifier: MIT
#include "kernels/lane_array.h"
#include "kernels/lanes.h"
#include "kernels/measure.h"

#include <mpi.h>

#include <algorithm>
#include <array>

namespace benchmarks {

namespace {

using fabseq::LaneArray;
using fabseq::native_lanes;
using Vector = fabseq::Lanes<8>;

/// a = b + s c as in STREAM (McCalpin). Counted are the three words that the loop names; that a is fetched
/// into the caches before it is written (write-allocate) makes four words on the bus, and is not counted.
class Triad {
 public:
  static constexpr std::size_t length = 16'000'000;  // an array is larger than any cache of a core's share
  static constexpr double bytes = 3.0 * sizeof(double) * length;

  void operator()() {
    for (std::size_t i = 0; i < length; ++i) a_[i] = b_[i] + scale_ * c_[i];
    benchmark::DoNotOptimize(a_.data());
    benchmark::ClobberMemory();
  }

 private:
  double scale_ = 3.0;
  LaneArray a_ = LaneArray(length, 0.0), b_ = LaneArray(length, 1.0), c_ = LaneArray(length, 2.0);
};

/// Multiplications with addition that do not wait for each other: enough chains to fill the pipes, few enough
/// to stay in registers.
constexpr int chains = 12 * native_lanes / 8;
constexpr int steps = 4'000'000;
constexpr double chained_flops = 2.0 * 8 * chains * steps;

void multiply_and_add() {
  // Not by DoNotOptimize: with it some runs were a hundred times too slow, as with numbers below the normal
  // range.
  const volatile double one = 1.0, small = 1e-9;
  const Vector factor = Vector::broadcast(one), term = Vector::broadcast(small);
  std::array<Vector, chains> sums;
  sums.fill(Vector::zero());
  for (int step = 0; step < steps; ++step)
#pragma GCC unroll 12
    for (int chain = 0; chain < chains; ++chain) sums[chain] = sums[chain] * factor + term;
  for (int chain = 1; chain < chains; ++chain) sums[0] += sums[chain];
  benchmark::DoNotOptimize(sums[0][0]);
}

template <class Call>
double best_seconds(int passes, Call&& call) {
  call();
  MPI_Barrier(MPI_COMM_WORLD);
  double best = 1e9;
  for (int pass = 0; pass < passes; ++pass) {
    const double start = MPI_Wtime();
    call();
    best = std::min(best, MPI_Wtime() - start);
  }
  return best;
}

}  // namespace

MachineLimits measure_limits() {
  Triad triad;
  return {Triad::bytes / best_seconds(5, triad), chained_flops / best_seconds(3, multiply_and_add)};
}

void add_machine() {
  add("machine/triad", 5, [](benchmark::State& state) {
    Triad triad;
    measure(state, {.bytes = Triad::bytes}, triad);
  });
  add("machine/fma", 3,
      [](benchmark::State& state) { measure(state, {.flops = chained_flops}, multiply_and_add); });
}

}  // namespace benchmarks
