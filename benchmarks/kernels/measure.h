// SPDX-License-Identifier: MIT
/// \file
/// How a kernel is timed, and what is counted.
#pragma once

#include <mpi.h>

#include "kernels/kernel_cost.h"
#include <benchmark/benchmark.h>
#include <functional>
#include <string>

namespace benchmarks {

/// Adds a benchmark whose loop runs `calls` times. The number is fixed, since all ranks do the same at once.
inline void add(const std::string& name, int calls, const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark(name.c_str(), body)
      ->Iterations(calls)
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}

/// Rates of a benchmark whose loop is over.
inline void report(benchmark::State& state, const Cost& cost) {
  const auto set = [&](const char* name, double value) {
    if (value > 0.0)
      state.counters[name] = benchmark::Counter(value, benchmark::Counter::kIsIterationInvariantRate);
  };
  set("dof", cost.unknowns);
  set("bytes", cost.bytes);
  set("flops", cost.flops);
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
  report(state, cost);
  return seconds;
}

}  // namespace benchmarks
