// SPDX-License-Identifier: MIT
#include "fabseq/mma/mma.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"  // -log_view counts what is sent here
#include "mma/mma_subproblem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace fabseq {

namespace {

constexpr double asymptote_gap = 0.1;     // a step covers at most 1 - gap of the way to an asymptote
constexpr double least_curvature = 1e-5;  // of every row, over the range (Svanberg 2007)
// A subproblem that does not converge is tried again with so much more curvature.
constexpr double conservative_factor = 1e3;
constexpr int conservative_attempts = 5;
constexpr double still = 1e-7;         // fraction of the range: smaller steps have no direction
constexpr double least_width = 1e-12;  // fraction of the range: a variable with less room stays

void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

void check_sizes(std::size_t n, std::span<const double> x, std::span<const double> objective_gradient,
                 std::span<const double> values, std::span<const std::vector<double>> gradients,
                 std::span<const double> lower, std::span<const double> upper, const MmaRows& rows) {
  const std::size_t m = values.size();
  require(x.size() == n && objective_gradient.size() == n && lower.size() == n && upper.size() == n,
          "Mma::update: vectors must have an entry for each of this rank's variables");
  require(gradients.size() == m && rows.a.size() == m && rows.c.size() == m && rows.d.size() == m,
          "Mma::update: gradients, a, c and d must have an entry a row");
  for (std::size_t i = 0; i < m; ++i)
    require(rows.a[i] >= 0.0 && rows.c[i] >= 0.0 && rows.d[i] >= 0.0 && rows.c[i] + rows.d[i] > 0.0 &&
                (rows.a[i] == 0.0 || rows.a0 > 0.0),
            "Mma::update: a, c, d must not be negative, c + d must be positive, and so must a0 where a is");
  require(std::all_of(gradients.begin(), gradients.end(), [n](const auto& row) { return row.size() == n; }),
          "Mma::update: each gradient must have an entry for each of this rank's variables");
}

// The same verdict on all ranks; gradients are checked by the subproblem, which reads them anyway.
void check_numbers(MPI_Comm comm, std::span<const double> x, std::span<const double> values,
                   std::span<const double> lower, std::span<const double> upper) {
  const auto finite = [](std::span<const double> numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double value) { return std::isfinite(value); });
  };
  bool good = finite(x) && finite(lower) && finite(upper);
  for (std::size_t j = 0; j < x.size(); ++j) good = good && lower[j] <= upper[j];
  std::array<int, 2> bad = {good ? 0 : 1, finite(values) ? 0 : 1};
  MPI_Allreduce(MPI_IN_PLACE, bad.data(), 2, MPI_INT, MPI_MAX, comm);
  if (bad[0] != 0) throw NumericalError("MMA: a variable or its bounds are not finite, or out of order");
  if (bad[1] != 0) throw NumericalError("MMA: the value of a row is not finite");
}

// The approximations have hardly any curvature where an objective and its gradient have vanished, and steep
// rows then have no minimum that Newton's method could find. More conservative ones do, with shorter steps
// [Svanberg 2002].
std::vector<double> solve_kept_rows(MPI_Comm comm, MmaBox box, std::span<const double> objective_gradient,
                                    std::span<const std::span<const double>> gradients,
                                    const std::vector<double>& values, const MmaRows& rows,
                                    MmaReport& report) {
  for (int attempt = 0; attempt < conservative_attempts; ++attempt) {
    MmaVariables variables(comm, box, objective_gradient, gradients);
    report = solve_mma_subproblem(comm, variables, values, rows);
    if (report.converged) return {variables.step().begin(), variables.step().end()};
    for (double& curvature : box.curvature) curvature *= conservative_factor;
  }
  throw NumericalError("MMA: the subproblem has not converged after " + std::to_string(report.newton_steps) +
                       " steps, residual " + formatted("%f", report.kkt_residual));
}

// Steps of the variables. Rows that stay fulfilled wherever the variables go are left out: their multipliers
// are 0.
std::vector<double> solve_subproblem(MPI_Comm comm, const MmaBox& box,
                                     std::span<const double> objective_gradient,
                                     const std::vector<double>& values,
                                     std::span<const std::vector<double>> gradients, const MmaRows& rows,
                                     MmaReport& report) {
  const std::vector<std::span<const double>> all(gradients.begin(), gradients.end());
  const std::vector<double> changes = largest_changes(comm, box, all);
  std::vector<std::size_t> kept;
  std::vector<std::span<const double>> kept_gradients;
  std::vector<double> kept_values;
  MmaRows kept_rows;
  kept_rows.a0 = rows.a0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] + changes[i] < 0.0) continue;  // not so if the gradient is not a number
    kept.push_back(i);
    kept_gradients.push_back(all[i]);
    kept_values.push_back(values[i]);
    kept_rows.add(1, rows.a[i], rows.c[i], rows.d[i]);
  }
  std::vector<double> step =
      solve_kept_rows(comm, box, objective_gradient, kept_gradients, kept_values, kept_rows, report);
  std::vector<double> multipliers(values.size());
  for (std::size_t k = 0; k < kept.size(); ++k) multipliers[kept[k]] = report.multipliers[k];
  report.multipliers = std::move(multipliers);
  return step;
}

}  // namespace

void MmaRows::add(std::size_t count, double row_a, double row_c, double row_d) {
  a.insert(a.end(), count, row_a);
  c.insert(c.end(), count, row_c);
  d.insert(d.end(), count, row_d);
}

Mma::Mma(MPI_Comm comm, std::size_t local, const MmaSettings& settings) : comm_(comm), settings_(settings) {
  for (auto* vector : {&state_.low, &state_.upp, &state_.previous, &state_.before_previous})
    vector->assign(local, 0.0);
}

void Mma::restore(MmaState state) {
  const std::size_t n = state_.low.size();
  require(state.low.size() == n && state.upp.size() == n && state.previous.size() == n &&
              state.before_previous.size() == n,
          "Mma::restore: the state must have an entry for each of this rank's variables");
  state_ = std::move(state);
}

// Svanberg's rule: away from a variable that keeps its direction, closer to one that oscillates.
void Mma::move_asymptotes(std::span<const double> x, std::span<const double> lower,
                          std::span<const double> upper) {
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double range = upper[j] - lower[j];
    double below = settings_.asymptote_initial * range, above = below;
    if (state_.iteration >= 2) {
      const double step = x[j] - state_.previous[j],
                   step_before = state_.previous[j] - state_.before_previous[j];
      double factor = 1.0;
      // The direction of a step that is only rounding must not decide anything.
      if (std::min(std::abs(step), std::abs(step_before)) > still * range)
        factor =
            (step > 0.0) == (step_before > 0.0) ? settings_.asymptote_increase : settings_.asymptote_decrease;
      below = factor * (state_.previous[j] - state_.low[j]);
      above = factor * (state_.upp[j] - state_.previous[j]);
    }
    const double floor = settings_.asymptote_floor * range, ceiling = settings_.asymptote_ceiling * range;
    state_.low[j] = x[j] - std::clamp(below, floor, ceiling);
    state_.upp[j] = x[j] + std::clamp(above, floor, ceiling);
  }
}

// How far the variables may go around x: within their bounds, the move limit, and short of the asymptotes.
MmaBox Mma::box(std::span<const double> x, std::span<const double> lower, std::span<const double> upper,
                double move_limit) const {
  MmaBox result(x.size());
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double range = upper[j] - lower[j];
    const double below = x[j] - state_.low[j], above = state_.upp[j] - x[j];
    const double down = std::min({x[j] - lower[j], (1.0 - asymptote_gap) * below, move_limit * range});
    const double up = std::min({upper[j] - x[j], (1.0 - asymptote_gap) * above, move_limit * range});
    if (!(down + up > least_width * range)) continue;  // stays
    result.width[j] = down + up;
    result.lower_distance[j] = below / result.width[j];
    result.upper_distance[j] = above / result.width[j];
    result.alpha[j] = -down / result.width[j];
    result.beta[j] = up / result.width[j];
    result.curvature[j] = least_curvature / range;
  }
  return result;
}

MmaReport Mma::update(std::span<double> x, std::span<const double> objective_gradient,
                      std::span<const double> values, std::span<const std::vector<double>> gradients,
                      std::span<const double> lower, std::span<const double> upper, double move_limit,
                      const MmaRows& rows) {
  const std::size_t n = state_.low.size();
  check_sizes(n, x, objective_gradient, values, gradients, lower, upper, rows);
  check_numbers(comm_, x, values, lower, upper);
  std::vector<double> shared(values.begin(), values.end());
  broadcast(comm_, shared);

  for (std::size_t j = 0; j < n; ++j) x[j] = std::clamp(x[j], lower[j], upper[j]);
  move_asymptotes(x, lower, upper);

  const MmaBox box = this->box(x, lower, upper, move_limit);
  MmaReport report;
  const std::vector<double> step =
      solve_subproblem(comm_, box, objective_gradient, shared, gradients, rows, report);
  for (std::size_t j = 0; j < n; ++j) {
    state_.before_previous[j] = std::exchange(state_.previous[j], x[j]);
    x[j] = std::clamp(x[j] + box.width[j] * step[j], lower[j], upper[j]);
  }
  ++state_.iteration;
  return report;
}

}  // namespace fabseq
