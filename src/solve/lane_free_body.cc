// SPDX-License-Identifier: MIT
#include "fabseq/solve/lane_free_body.h"

#include "cg/free_motions.h"
#include "cg/lane_cg.h"
#include "fabseq/base/log_event.h"
#include "multigrid/lane_layout.h"
#include "solve/lane_report.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace fabseq {

namespace {

/// Added to the last level's diagonal, relative to it: far below its elastic modes, far above rounding.
constexpr double shift = 1e-7;

LaneCycle free_body_cycle(LaneCycle cycle) {
  cycle.shift = shift;
  cycle.islands = false;
  return cycle;
}

SystemDomain without_supports(SystemDomain domain) {
  std::fill(domain.fixed.begin(), domain.fixed.end(), 0);
  return domain;
}

}  // namespace

template <int Dim>
struct LaneFreeBody<Dim>::Engine {
  using Problem = LaneElasticityProblem<Dim>;

  Engine(const Grid<Dim>& grid, const SystemDomain& domain, double poisson, const LaneCycle& cycle,
         std::span<const double> stiffness)
      : problem(grid.domain().thickness, poisson),
        hierarchy(grid, without_supports(domain)),
        layout(grid, hierarchy.level(0), Dim),
        solver(hierarchy, problem, free_body_cycle(cycle)) {
    LaneArray& coefficients = solver.matrix().coefficients();
    const std::vector<std::int64_t> numbers = hierarchy.element_numbers(domain);
    for (std::size_t e = 0; e < stiffness.size(); ++e) coefficients[numbers[e]] = stiffness[e];
    solver.set_up();
    motions.emplace(hierarchy.level(0), coefficients);
    solver.keep_free_of(*motions);
  }

  Problem problem;
  LaneHierarchy<Dim> hierarchy;
  LaneLayout<Dim> layout;
  LaneCg<Problem, 1> solver;
  std::optional<FreeMotions<Dim>> motions;  ///< made once the operator is known
};

template <int Dim>
LaneFreeBody<Dim>::LaneFreeBody(const Grid<Dim>& grid, const SystemDomain& domain, double poisson,
                                const LaneCycle& cycle, std::span<const double> stiffness)
    : engine_(std::make_unique<Engine>(grid, domain, poisson, cycle, stiffness)) {}

template <int Dim>
LaneFreeBody<Dim>::~LaneFreeBody() = default;

template <int Dim>
SolveReport LaneFreeBody<Dim>::solve(std::span<const double> load, std::span<double> displacement,
                                     double tolerance) {
  static const LogEvent event("fabseq free body");
  const auto scope = event.enter();
  LaneVector owned(static_cast<int>(load.size() / Dim), Dim, 1);
  std::copy(load.begin(), load.end(), owned.values.begin());
  LaneArray forces, solution;
  engine_->layout.to_mesh(owned, 1, forces);
  engine_->motions->balance(forces);
  const LaneStop stop{.tolerance = tolerance, .max_iterations = lane_iterations};
  SolveReport report = report_of(engine_->solver.solve(forces, solution, 1, stop)[0]);
  engine_->layout.to_owned(solution, 1, owned);
  std::copy(owned.values.begin(), owned.values.end(), displacement.begin());
  return report;
}

FABSEQ_INSTANTIATE_CLASS(LaneFreeBody);

}  // namespace fabseq
