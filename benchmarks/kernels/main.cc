// SPDX-License-Identifier: MIT
/// \file
/// Speed of the lane kernels beside the limits of the machine (docs/developer/measuring.md):
///
///     build/release/benchmarks/kernels [--elements=80] [options of Google Benchmark]
///
/// The box has ELEMENTS x ELEMENTS/2 x ELEMENTS elements. Medians of five repetitions, unless
/// --benchmark_repetitions says otherwise. Under mpirun every rank does the same by itself, at the same time;
/// the figures are of one core while all of them work.
#include "fabseq/base/error.h"
#include "fabseq/base/machine_cores.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "kernels/lanes.h"
#include "kernels/measure.h"

#include <petscsys.h>

#include <cstdio>
#include <string>
#include <vector>

namespace benchmarks {
namespace {

/// A line a benchmark: the median where there are repetitions.
class MedianReporter : public benchmark::ConsoleReporter {
 public:
  MedianReporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> shown;
    for (Run run : runs) {
      const bool single = run.run_type == Run::RT_Iteration && (run.repetitions < 2 || run.error_occurred);
      if (!single && run.aggregate_name != "median") continue;
      run.run_name.iterations.clear();
      run.run_name.repetitions.clear();
      run.run_name.time_type.clear();
      shown.push_back(run);
    }
    if (!shown.empty()) ConsoleReporter::ReportRuns(shown);
  }
};

/// For all ranks but the first.
class SilentReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>&) override {}
};

void run_benchmarks(std::vector<std::string> words) {
  const bool first = fabseq::rank_of(PETSC_COMM_WORLD) == 0;
  // What comes later on the command line holds.
  words.insert(words.begin() + 1, "--benchmark_repetitions=5");
  std::vector<char*> arguments;
  for (std::string& word : words)
    if (first || word.rfind("--benchmark_out=", 0) != 0) arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());  // takes its own options out
  int elements = 80;
  for (int i = 1; i < count; ++i)
    if (std::sscanf(arguments[i], "--elements=%d", &elements) != 1 || elements < 2)
      throw fabseq::InputError(std::string(arguments[i]) + ": --elements=N from 2 up, or see --help");
  benchmark::AddCustomContext("cores at once", std::to_string(fabseq::size_of(PETSC_COMM_WORLD)));
  benchmark::AddCustomContext("machine", fabseq::machine_text(PETSC_COMM_WORLD));
  benchmark::AddCustomContext("lanes of a register", std::to_string(fabseq::native_lanes));
  benchmark::AddCustomContext("elements", std::to_string(elements) + " x " + std::to_string(elements / 2) +
                                              " x " + std::to_string(elements));
  add_machine();
  add_operators(elements);
  add_multigrid(elements);
  add_solve(elements);
  MedianReporter median;
  SilentReporter silent;
  benchmark::RunSpecifiedBenchmarks(first ? static_cast<benchmark::BenchmarkReporter*>(&median) : &silent);
}

}  // namespace
}  // namespace benchmarks

int main(int argc, char** argv) {
  return fabseq::run_session(
      {argv[0]}, [&] { benchmarks::run_benchmarks(std::vector<std::string>(argv, argv + argc)); });
}
