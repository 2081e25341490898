// SPDX-License-Identifier: MIT
/// \file
/// Iterations and true errors of the lane engine on hard cases (docs/performance.md):
///
///     hard_cases [-scale 0.5] [-tolerance 1e-5] [-only NAME] [-cycle v|w|k] [-islands 0] [-error_factor 1e9]
///     hard_cases -history 30 [-only NAME]      error and residuals of the hardest lane after each iteration,
///     as CSV
#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"
#include "fabseq/lanes/lane_cg.h"

#include "hard_cases/cases.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace {

using benchmarks::LaneCase;
using fabseq::LaneArray;
using Solver = fabseq::LaneCg<LaneCase::Problem, LaneCase::lanes>;

struct Settings {
  double scale = 1.0;
  std::string only;
  fabseq::LaneCycle cycle;
  fabseq::LaneStop stop{1e-5, 300};
  int history = 0;  ///< iterations to tell of; 0: the table
};

double real_option(const char* name, double value) {
  fabseq::check(PetscOptionsGetReal(nullptr, nullptr, name, &value, nullptr));
  return value;
}

std::string text_option(const char* name) {
  std::array<char, 64> text{};
  fabseq::check(PetscOptionsGetString(nullptr, nullptr, name, text.data(), text.size(), nullptr));
  return text.data();
}

Settings read_settings() {
  Settings settings;
  settings.scale = real_option("-scale", 1.0);
  settings.only = text_option("-only");
  const std::string cycle = text_option("-cycle");
  if (cycle == "v") settings.cycle.kind = fabseq::SolverCycle::v;
  if (cycle == "w") settings.cycle.kind = fabseq::SolverCycle::w;
  settings.cycle.islands = real_option("-islands", 1.0) != 0.0;
  settings.stop.tolerance = real_option("-tolerance", 1e-5);
  settings.stop.error_factor = real_option("-error_factor", settings.stop.error_factor);
  settings.history = static_cast<int>(real_option("-history", 0.0));
  return settings;
}

using LaneNumbers = std::array<double, LaneCase::lanes>;

/// Euclidean norm of each lane over all ranks.
LaneNumbers norms(Solver& solver, const LaneArray& values) {
  auto squares = solver.matrix().dot(values.data(), values.data());
  fabseq::sum_in_place(solver.matrix().level().comm, squares);
  for (double& square : squares) square = std::sqrt(square);
  return squares;
}

/// |a - b| relative to |b| in each lane, 0 where b is.
LaneNumbers relative_differences(Solver& solver, const LaneArray& a, const LaneArray& b) {
  LaneArray difference = a;
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= b[i];
  LaneNumbers result = norms(solver, difference);
  const LaneNumbers sizes = norms(solver, b);
  for (int lane = 0; lane < LaneCase::lanes; ++lane)
    result[lane] = sizes[lane] > 0.0 ? result[lane] / sizes[lane] : 0.0;
  return result;
}

/// Two solves to this tolerance differ by less than 1e-9.
constexpr fabseq::LaneStop tight{1e-12, 1000, 1e9};

/// Begins from zero for every line: the solver tells nothing under way.
void print_history(const benchmarks::HardCase& hard, const Settings& settings) {
  LaneCase lane_case(PETSC_COMM_WORLD, hard.part);
  Solver solver(lane_case.hierarchy(), lane_case.problem(), settings.cycle);
  lane_case.fill(solver.matrix().coefficients());
  LaneArray load = lane_case.load();
  solver.matrix().clear_held(load.data());
  solver.set_up();
  LaneArray rest = load, exact, solution, image(load.size());
  const auto outcomes = solver.solve(rest, exact, LaneCase::lanes, tight);
  const auto hardest =
      std::max_element(outcomes.begin(), outcomes.end(),
                       [](const auto& a, const auto& b) { return a.iterations < b.iterations; }) -
      outcomes.begin();
  for (int iteration = 1; iteration <= settings.history; ++iteration) {
    rest = load;
    const auto now = solver.solve(rest, solution, LaneCase::lanes, {1e-14, iteration, 1e9});
    (void)solver.matrix().apply(solution.data(), image.data());
    const double residual = relative_differences(solver, image, load)[hardest];
    const double error = relative_differences(solver, solution, exact)[hardest];
    if (fabseq::rank_of(PETSC_COMM_WORLD) == 0)
      std::printf("%s,%d,%.3e,%.3e,%.3e\n", hard.name.c_str(), iteration, error, residual,
                  now[hardest].residual);
  }
}

void run(const benchmarks::HardCase& hard, const Settings& settings) {
  LaneCase lane_case(PETSC_COMM_WORLD, hard.part);
  Solver solver(lane_case.hierarchy(), lane_case.problem(), settings.cycle);
  lane_case.fill(solver.matrix().coefficients());
  LaneArray load = lane_case.load();
  const LaneArray same_load = load;
  LaneArray solution, exact;
  const auto start = std::chrono::steady_clock::now();
  solver.set_up();
  const auto outcomes = solver.solve(load, solution, LaneCase::lanes, settings.stop);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  load = same_load;
  solver.solve(load, exact, LaneCase::lanes, tight);
  std::vector<int> iterations;
  bool converged = true;
  for (const auto& outcome : outcomes) {
    iterations.push_back(outcome.iterations);
    converged = converged && outcome.converged;
  }
  std::sort(iterations.begin(), iterations.end());
  const auto error = relative_differences(solver, solution, exact);
  const double filled = lane_case.filled();
  if (fabseq::rank_of(PETSC_COMM_WORLD) != 0) return;
  std::printf("| %-12s | %-40s | %3.0f %% | %3d | %3d | %7.1e | %6.3f |%s\n", hard.name.c_str(),
              hard.what.c_str(), 100.0 * filled, iterations.back(), iterations[LaneCase::lanes / 2],
              *std::max_element(error.begin(), error.end()), seconds.count() / LaneCase::lanes,
              converged ? "" : " not converged");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  fabseq::check(PetscInitialize(&argc, &argv, nullptr, nullptr));
  const Settings settings = read_settings();
  if (fabseq::rank_of(PETSC_COMM_WORLD) == 0)
    std::puts(settings.history > 0 ? "case,iteration,error,residual,preconditioned_residual"
                                   : "| case | what | fill | worst | median | error | seconds a lane |\n"
                                     "| - | - | - | - | - | - | - |");
  for (const auto& hard : benchmarks::hard_cases(settings.scale)) {
    if (!settings.only.empty() && settings.only != hard.name) continue;
    if (settings.history > 0)
      print_history(hard, settings);
    else
      run(hard, settings);
  }
  fabseq::check(PetscFinalize());
}
