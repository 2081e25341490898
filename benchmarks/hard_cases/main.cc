/// \file
/// Iterations and true errors of the lane engine on hard cases (docs/performance.md):
///
///     hard_cases [-scale 0.5] [-tolerance 1e-5] [-only NAME] [-cycle v|w|k] [-islands 0] [-error_factor 1e9]
#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"
#include "fabseq/solve/lane_cg.h"

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
  return settings;
}

/// Relative error in each lane, 0 where there is no load.
std::array<double, LaneCase::lanes> errors(Solver& solver, const LaneArray& solution,
                                           const LaneArray& exact) {
  auto& matrix = solver.matrix();
  LaneArray difference = solution;
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= exact[i];
  auto squares = matrix.dot(difference.data(), difference.data());
  auto sizes = matrix.dot(exact.data(), exact.data());
  fabseq::sum_in_place(matrix.level().comm, squares);
  fabseq::sum_in_place(matrix.level().comm, sizes);
  std::array<double, LaneCase::lanes> result{};
  for (int lane = 0; lane < LaneCase::lanes; ++lane)
    if (sizes[lane] > 0.0) result[lane] = std::sqrt(squares[lane] / sizes[lane]);
  return result;
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
  // Two solves to this tolerance differ by less than 1e-9.
  const fabseq::LaneStop tight{1e-12, 1000, 1e9};
  solver.solve(load, exact, LaneCase::lanes, tight);
  std::vector<int> iterations;
  bool converged = true;
  for (const auto& outcome : outcomes) {
    iterations.push_back(outcome.iterations);
    converged = converged && outcome.converged;
  }
  std::sort(iterations.begin(), iterations.end());
  const auto error = errors(solver, solution, exact);
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
    std::printf(
        "| case | what | fill | worst | median | error | seconds a lane |\n| - | - | - | - | - | - | - |\n");
  for (const auto& hard : benchmarks::hard_cases(settings.scale))
    if (settings.only.empty() || settings.only == hard.name) run(hard, settings);
  fabseq::check(PetscFinalize());
}
