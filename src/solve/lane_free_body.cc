// SPDX-License-Identifier: MIT
#include "fabseq/solve/lane_free_body.h"

#include "fabseq/base/log_event.h"

#include <algorithm>
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
LaneFreeBody<Dim>::LaneFreeBody(const Grid<Dim>& grid, const SystemDomain& domain, double poisson,
                                const LaneCycle& cycle, std::span<const double> stiffness)
    : problem_(grid.domain().thickness, poisson),
      hierarchy_(grid, without_supports(domain)),
      layout_(grid, hierarchy_.level(0), Dim),
      solver_(hierarchy_, problem_, free_body_cycle(cycle)) {
  LaneArray& coefficients = solver_.matrix().coefficients();
  const std::vector<std::int64_t> numbers = hierarchy_.element_numbers(domain);
  for (std::size_t e = 0; e < stiffness.size(); ++e) coefficients[numbers[e]] = stiffness[e];
  solver_.set_up();
  motions_.emplace(hierarchy_.level(0), coefficients);
  solver_.keep_free_of(*motions_);
}

template <int Dim>
SolveReport LaneFreeBody<Dim>::solve(std::span<const double> load, std::span<double> displacement,
                                     double tolerance) {
  static const LogEvent event("fabseq free body");
  const auto scope = event.enter();
  LaneVector owned(static_cast<int>(load.size() / Dim), Dim, 1);
  std::copy(load.begin(), load.end(), owned.values.begin());
  LaneArray forces, solution;
  layout_.to_mesh(owned, 1, forces);
  motions_->balance(forces);
  const LaneStop stop{.tolerance = tolerance, .max_iterations = lane_iterations};
  SolveReport report = report_of(solver_.solve(forces, solution, 1, stop)[0]);
  layout_.to_owned(solution, 1, owned);
  std::copy(owned.values.begin(), owned.values.end(), displacement.begin());
  return report;
}

FABSEQ_INSTANTIATE_CLASS(LaneFreeBody);

}  // namespace fabseq
