// SPDX-License-Identifier: MIT
/// \file
/// The groups of benchmarks, a source each; how a kernel is timed; what the machine can do.
#pragma once

#include "kernels/kernel_cost.h"

#include <mpi.h>

#include <benchmark/benchmark.h>
#include <functional>
#include <string>

namespace benchmarks {

/// Triad and multiply-adds of a core.
void add_machine();
/// K x alone, on full boxes with `elements` along the longer edges.
void add_operators(int elements);
/// Parts of the preconditioner on a full box.
void add_multigrid(int elements);
/// Set-up and solve of eight layers of the V-shape.
void add_solve(int elements);

/// Limits of one core, while all ranks measure at once.
struct MachineLimits {
  double triad = 0.0;  ///< bytes a second
  double fma = 0.0;    ///< flops a second
};

/// Best of a few passes, about half a second. Collective on the world.
MachineLimits measure_limits();

/// Adds a benchmark whose loop runs `calls` times. The number is fixed, since all ranks do the same at once.
inline void add(const std::string& name, int calls, const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark(name.c_str(), body)
      ->Iterations(calls)
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}

/// Times `call`, once to bring its memory in, then in the loop, which begins on all ranks at the same time.
/// Returns seconds a call. Collective on the world.
template <class Call>
double measure(benchmark::State& state, const Cost& cost, Call&& call) {
  call();
  MPI_Barrier(MPI_COMM_WORLD);
  const double start = MPI_Wtime();
  for (auto _ : state) {
    call();
    benchmark::ClobberMemory();
  }
  const double seconds = (MPI_Wtime() - start) / static_cast<double>(state.iterations());
  const auto rate = [&](const char* name, double value) {
    if (value > 0.0)
      state.counters[name] = benchmark::Counter(value, benchmark::Counter::kIsIterationInvariantRate);
  };
  rate("dof", cost.unknowns);
  rate("bytes", cost.bytes);
  rate("flops", cost.flops);
  return seconds;
}

}  // namespace benchmarks
