// SPDX-License-Identifier: MIT
/// \file
/// Iterations and true errors of the lane engine on hard cases (docs/performance.md):
///
///     hard_cases [-scale 0.5] [-tolerance 1e-5] [-only NAME] [-cycle v|w|k] [-islands 0] [-error_factor 1e9]
///     hard_cases -history 30 [-only NAME]      error and residuals of the hardest lane after each iteration,
///     as CSV
#include "fabseq/base/formatted.h"
#include "fabseq/base/machine_cores.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"
#include "fabseq/base/session.h"
#include "lane_case.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace {

using benchmarks::DrawnPart;
using benchmarks::LaneCase;
using benchmarks::LaneSystem;
using fabseq::LaneArray;
using Solver = LaneSystem::Solver;
using fabseq::Index;
using fabseq::Point;

double distance(const Point<3>& a, const Point<3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

bool everything(const Point<3>&, const Index<3>&) { return true; }

/// A V-shape whose front runs ahead and stays behind: pieces that stand free until it closes.
DrawnPart wavy_front(double sharpness) {
  const auto time = [](const Point<3>& at, const Index<3>&) {
    const double wave = std::sin(9.0 * at[0]) * std::sin(7.0 * at[2]) * std::sin(5.0 * at[1]);
    return std::min(0.999, distance(at, {}) / 3.0 * (1.0 + 0.1 * wave));
  };
  return {.time = time, .sharpness = sharpness};
}

/// A ball in the air above a growing block is built early.
DrawnPart isolated_minimum() {
  return {.contains = everything, .time = [](const Point<3>& at, const Index<3>&) {
            const double ball = std::max(0.0, distance(at, {1.0, 0.5, 1.4}) - 0.35);
            return std::min(0.999, 0.05 + std::min(at[2] / 2.0, ball / 1.2));
          }};
}

/// A block on a column of `width` elements.
DrawnPart block_on_column(const Index<3>& elements, int width) {
  return {.contains = [=](const Point<3>& at, const Index<3>& index) {
    const auto in_column = [&](int axis) {
      const int offset = index[axis] - elements[axis] / 2;
      return offset >= -(width / 2) && offset < width - width / 2;
    };
    return at[2] < 0.1 || at[2] > 1.0 || (in_column(0) && in_column(1));
  }};
}

/// Sheets one element thick are built long before what is between them.
DrawnPart stiff_sheets() {
  return {.contains = everything, .time = [](const Point<3>& at, const Index<3>& index) {
            const double time = 0.35 * at[2] + 0.15 * at[0];
            return index[0] % 16 == 8 || index[2] % 16 == 9 ? 0.3 * time : time;
          }};
}

/// Walls one element thick on a slab.
DrawnPart thin_walls(const Index<3>& elements) {
  return {.contains = [middle = elements[1] / 2](const Point<3>& at, const Index<3>& index) {
    return at[2] < 0.1 || index[0] % 10 == 5 || index[1] == middle;
  }};
}

/// A lattice of columns and beams two elements thick that fills 2 % of the box.
DrawnPart lattice() {
  return {.contains = [](const Point<3>&, const Index<3>& index) {
    const auto on = [](int i, int period) {
      return i % period == period / 2 || i % period == period / 2 - 1;
    };
    const bool x = on(index[0], 40), y = on(index[1], 20), z = on(index[2], 40);
    return (x && y) || (x && z) || (y && z);
  }};
}

/// Nothing becomes part between a tenth and nine tenths of the time: empty layers.
DrawnPart empty_layers() {
  const auto time = [](const Point<3>& at, const Index<3>&) {
    return at[2] < 1.0 ? 0.1 * at[2] : 0.8 + 0.1 * at[2];
  };
  return {.time = time, .sharpness = 500.0};
}

/// Elements 8 times wider than high.
DrawnPart flat_elements() {
  const auto contains = [](const Point<3>& at, const Index<3>&) {
    return (at[2] < 2.4 || at[0] > 4.8) && at[2] > at[0] - 4.0;
  };
  const auto time = [](const Point<3>& at, const Index<3>&) { return (0.35 * at[2] + 0.15 * at[0]) / 4.0; };
  return {.size = {8.0, 4.0, 8.0}, .elements = {40, 20, 320}, .contains = contains, .time = time};
}

Index<3> scaled(Index<3> elements, double scale) {
  for (int& count : elements) count = std::max(2, static_cast<int>(std::lround(count * scale)));
  return elements;
}

struct HardCase {
  std::string name, what;
  DrawnPart part;
};

/// Easiest first. `scale` refines the grids; 0.5 halves the counts.
std::vector<HardCase> hard_cases(double scale) {
  const Index<3> elements = scaled(DrawnPart().elements, scale);
  std::vector<HardCase> cases{
      {"normal", "V-shape, tilted planes, N = 25, beta = 4N", {}},
      {"quiet", "the same in quiet void", {.quiet_void = true}},
      {"sharp", "beta = 500", {.sharpness = 500.0}},
      {"nu_0.45", "Poisson's ratio 0.45", {.poisson = 0.45}},
      {"layers_100", "N = 100, beta = 500", {.layer_count = 100, .sharpness = 500.0}},
      {"empty_layers", "layers with nothing in them", empty_layers()},
      {"flat_1_8", "elements 8 times wider than high", flat_elements()},
      {"tall_1_8", "elements 8 times higher than wide", {.elements = {160, 80, 20}}},
      {"wavy", "a wavy front, beta = 4N", wavy_front(100.0)},
      {"wavy_sharp", "the same, beta = 13.5N", wavy_front(337.5)},
      {"minimum", "an isolated minimum of the time", isolated_minimum()},
      {"column_2", "a block on a column of 2 x 2 elements", block_on_column(elements, 2)},
      {"column_1", "a block on a column of one element", block_on_column(elements, 1)},
      {"sheets", "stiff sheets one element thick", stiff_sheets()},
      {"lattice", "columns and beams 2 elements thick, fill 2 %", lattice()},
      {"walls", "walls one element thick", thin_walls(elements)}};
  for (HardCase& hard : cases) hard.part.elements = scaled(hard.part.elements, scale);
  return cases;
}

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
  settings.scale = real_option("-scale", settings.scale);
  settings.only = text_option("-only");
  const std::string cycle = text_option("-cycle");
  if (cycle == "v") settings.cycle.kind = fabseq::SolverCycle::v;
  if (cycle == "w") settings.cycle.kind = fabseq::SolverCycle::w;
  settings.cycle.islands = real_option("-islands", 1.0) != 0.0;
  settings.stop.tolerance = real_option("-tolerance", settings.stop.tolerance);
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
void print_history(const HardCase& hard, const Settings& settings) {
  LaneSystem system(PETSC_COMM_WORLD, hard.part, settings.cycle);
  auto& [lane_case, solver] = system;
  LaneArray load = lane_case.load();
  solver.matrix().clear_held(load.data());
  solver.set_up();
  LaneArray rest = load, exact, solution, image(load.size());
  const auto outcomes = solver.solve(rest, exact, LaneCase::lanes, tight);
  const auto hardest =
      std::ranges::max_element(outcomes, {}, &fabseq::LaneOutcome::iterations) - outcomes.begin();
  for (int iteration = 1; iteration <= settings.history; ++iteration) {
    rest = load;
    const auto now = solver.solve(rest, solution, LaneCase::lanes, {1e-14, iteration, 1e9});
    (void)solver.matrix().apply(solution.data(), image.data());
    const double residual = relative_differences(solver, image, load)[hardest];
    const double error = relative_differences(solver, solution, exact)[hardest];
    fabseq::print(fabseq::formatted("%s,%d,%.3e,%.3e,%.3e", hard.name.c_str(), iteration, error, residual,
                                    now[hardest].residual));
  }
}

void run(const HardCase& hard, const Settings& settings) {
  LaneSystem system(PETSC_COMM_WORLD, hard.part, settings.cycle);
  auto& [lane_case, solver] = system;
  const LaneArray load = lane_case.load();
  LaneArray rest = load, solution, exact;
  const double start = MPI_Wtime();
  solver.set_up();
  auto outcomes = solver.solve(rest, solution, LaneCase::lanes, settings.stop);
  const double seconds = MPI_Wtime() - start;
  rest = load;
  solver.solve(rest, exact, LaneCase::lanes, tight);
  const bool converged = std::ranges::all_of(outcomes, &fabseq::LaneOutcome::converged);
  std::ranges::sort(outcomes, {}, &fabseq::LaneOutcome::iterations);
  const auto error = relative_differences(solver, solution, exact);
  const double filled = lane_case.filled();
  fabseq::print(fabseq::formatted("| %-12s | %-40s | %3.0f %% | %3d | %3d | %7.1e | %6.3f |%s",
                                  hard.name.c_str(), hard.what.c_str(), 100.0 * filled,
                                  outcomes.back().iterations, outcomes[LaneCase::lanes / 2].iterations,
                                  *std::max_element(error.begin(), error.end()), seconds / LaneCase::lanes,
                                  converged ? "" : " not converged"));
}

}  // namespace

int main(int argc, char** argv) {
  fabseq::check(PetscInitialize(&argc, &argv, nullptr, nullptr));
  const Settings settings = read_settings();
  if (settings.history == 0) fabseq::print("machine: " + fabseq::machine_text(PETSC_COMM_WORLD) + "\n");
  fabseq::print(settings.history > 0 ? "case,iteration,error,residual,preconditioned_residual"
                                     : "| case | what | fill | worst | median | error | seconds a lane |\n"
                                       "| - | - | - | - | - | - | - |");
  for (const auto& hard : hard_cases(settings.scale))
    if (settings.only.empty() || settings.only == hard.name)
      (settings.history > 0 ? print_history : run)(hard, settings);
  fabseq::check(PetscFinalize());
}
