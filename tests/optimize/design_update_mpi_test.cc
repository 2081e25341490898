// SPDX-License-Identifier: MIT
/// Steps of field and time points together: the same however they are spread over the ranks, and after a
/// restart.
#include "fabseq/base/mpi.h"
#include "fabseq/optimize/design_update.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace fabseq {
namespace {

constexpr std::size_t variables = 23;  // of the field, all ranks

/// Minimizes the distance to a target over a field, dealt out to the ranks of a communicator, and time
/// points; their sum is bounded.
class Minimization {
 public:
  explicit Minimization(MPI_Comm comm, const DesignSpace& space = {}) : comm_(comm) {
    const std::size_t rank = rank_of(comm), ranks = size_of(comm), first = rank * variables / ranks;
    for (std::size_t i = first; i < (rank + 1) * variables / ranks; ++i) {
      design_.field.push_back(space.of(i).from_unit(0.5));
      target_.field.push_back(
          space.of(i).from_unit(0.1 + 0.8 * std::abs(std::sin(1.0 + static_cast<double>(i)))));
    }
    design_.layer_variables = {0.25, 0.5, 0.75};
    target_.layer_variables = {0.1, 0.62, 0.9};
    update_.emplace(comm, space.from(first), false, time_point_variables(4), design_, MmaSettings{});
  }

  double step(double move_limit = 0.05) {
    ProblemGradients gradients;
    gradients.objective = design_;
    double sum_of_points = -bound;
    for (std::size_t i = 0; i < design_.field.size(); ++i)
      gradients.objective.field[i] = 2.0 * (design_.field[i] - target_.field[i]);
    for (std::size_t j = 0; j < 3; ++j) {
      gradients.objective.layer_variables[j] =
          2.0 * (design_.layer_variables[j] - target_.layer_variables[j]);
      sum_of_points += design_.layer_variables[j];
    }
    gradients.constraints = {
        {sum_of_points, {std::vector<double>(design_.field.size(), 0.0), {1.0, 1.0, 1.0}}}};
    return update_->update(design_, gradients, move_limit).change;
  }
  /// Field of all ranks, then time points.
  std::vector<double> whole() const {
    const std::size_t rank = rank_of(comm_), ranks = size_of(comm_);
    std::vector<double> result(variables, 0.0);
    std::copy(design_.field.begin(), design_.field.end(),
              result.begin() + static_cast<std::ptrdiff_t>(rank * variables / ranks));
    sum_in_place(comm_, result);
    result.insert(result.end(), design_.layer_variables.begin(), design_.layer_variables.end());
    return result;
  }
  const Design& design() const { return design_; }
  const Design& target() const { return target_; }
  DesignUpdate& update() { return *update_; }
  void set_design(const Design& design) { design_ = design; }

  static constexpr double bound = 1.5;  // of the sum of the time points; the target's is 1.62

 private:
  MPI_Comm comm_;
  Design design_, target_;
  std::optional<DesignUpdate> update_;
};

TEST(DesignUpdate, FindsTheMinimum) {
  Minimization problem(MPI_COMM_WORLD);
  for (int step = 0; step < 150; ++step) problem.step(0.05 * std::pow(0.95, step));
  for (std::size_t i = 0; i < problem.design().field.size(); ++i)
    EXPECT_NEAR(problem.design().field[i], problem.target().field[i], 2e-3);
  // All shifted alike, onto the bound.
  for (std::size_t j = 0; j < 3; ++j)
    EXPECT_NEAR(problem.design().layer_variables[j], problem.target().layer_variables[j] - 0.04, 1e-3);
}

/// Their range for a step is a layer to either side.
TEST(DesignUpdate, TimePointsMoveByAShareOfALayer) {
  Minimization problem(MPI_COMM_WORLD);
  const std::vector<double> before = problem.design().layer_variables;
  const double change = problem.step(0.1);
  double largest = 0.0;
  for (std::size_t j = 0; j < 3; ++j)
    largest = std::max(largest, std::abs(problem.design().layer_variables[j] - before[j]));
  EXPECT_LE(largest, 0.1 * 2.0 / 4.0 + 1e-12);
  EXPECT_GT(largest, 0.04);
  EXPECT_LE(change, 0.1 + 1e-12);
}

TEST(DesignUpdate, DoesNotDependOnTheRanks) {
  for (const DesignSpace& space : {DesignSpace{}, DesignSpace{{{1e-3, 1.0, true}}},
                                   DesignSpace{{{0.0, 1.0, false}, {1e-3, 1.0, true}, {-1.0, 3.0, false}}}}) {
    Minimization parallel(MPI_COMM_WORLD, space), serial(MPI_COMM_SELF, space);
    for (int step = 0; step < 12; ++step) EXPECT_NEAR(parallel.step(), serial.step(), 1e-9);
    const std::vector<double> found = parallel.whole(), expected = serial.whole();
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9);
  }
}

TEST(DesignUpdate, GoesOnFromASavedState) {
  Minimization expected(MPI_COMM_WORLD), restored(MPI_COMM_WORLD);
  for (int step = 0; step < 5; ++step) expected.step();
  CheckpointState state;
  expected.update().save(state);
  EXPECT_EQ(state.array("optimizer/time_points_previous").size(), 3u);
  EXPECT_EQ(state.field("optimizer/previous").size(), expected.design().field.size());
  restored.set_design(expected.design());
  restored.update().restore(state);
  for (int step = 0; step < 5; ++step) {
    expected.step();
    restored.step();
  }
  EXPECT_EQ(restored.whole(), expected.whole());
}

/// min (x_0 + ... - sum)^2 + (x_0 - ... alternating - difference)^2 + x . x / 100, all but the last as
/// residuals: the normal equations say where.
TEST(DesignUpdate, ResidualsAreLeastSquares) {
  constexpr double wanted[] = {9.0, 1.0}, weight = 0.01;
  const std::size_t rank = rank_of(MPI_COMM_WORLD), ranks = size_of(MPI_COMM_WORLD);
  const std::size_t first = rank * variables / ranks, count = (rank + 1) * variables / ranks - first;
  const auto coefficient = [&](int residual, std::size_t i) {
    return residual == 0 || (first + i) % 2 == 0 ? 1.0 : -1.0;
  };
  Design design{std::vector<double>(count, 0.5), {}};
  DesignUpdate update(MPI_COMM_WORLD, {}, false, {}, design, MmaSettings{});
  StepReport report;
  for (int step = 0; step < 80; ++step) {
    ProblemGradients gradients;
    gradients.objective = design;
    for (double& entry : gradients.objective.field) entry *= 2.0 * weight;
    for (int k = 0; k < 2; ++k) {
      Design gradient = design;
      double value = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        gradient.field[i] = coefficient(k, i);
        value += coefficient(k, i) * design.field[i];
      }
      gradients.residuals.push_back({sum(MPI_COMM_WORLD, value) - wanted[k], gradient});
    }
    report = update.update(design, gradients, 0.2 * std::pow(0.93, step));
  }
  // x_i = p for even i (12 of 23), q for odd ones:
  //   weight p + r + s = 0, weight q + r - s = 0, r = 12 p + 11 q - 9, s = 12 p - 11 q - 1.
  const double a = weight + 24.0, b = weight + 22.0;  // the mixed terms cancel
  const double p = (wanted[0] + wanted[1]) / a, q = (wanted[0] - wanted[1]) / b;
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_NEAR(design.field[i], (first + i) % 2 == 0 ? p : q, 2e-3) << first + i;
  EXPECT_EQ(report.mma.multipliers.size(), 4u);
  EXPECT_EQ(report.mma.largest_violation, 0.0);  // there is no constraint to relax
}

/// One step goes to the minimum along a direction where the rest is flat; without the residual's curvature
/// the objective's gradient would ask for the move limit.
TEST(DesignUpdate, AResidualKnowsItsCurvature) {
  const std::size_t rank = rank_of(MPI_COMM_WORLD), ranks = size_of(MPI_COMM_WORLD);
  const std::size_t count = (rank + 1) * variables / ranks - rank * variables / ranks;
  Design design{std::vector<double>(count, 0.5), {}};
  DesignUpdate update(MPI_COMM_WORLD, {}, false, {}, design, MmaSettings{});
  ProblemGradients gradients;
  gradients.objective = {std::vector<double>(count, 0.0), {}};
  // 0 where all variables are 0.01 smaller
  gradients.residuals = {{0.23, {std::vector<double>(count, 1.0), {}}}};
  update.update(design, gradients, 0.2);
  for (const double value : design.field) EXPECT_NEAR(value, 0.49, 1e-3);
}

}  // namespace
}  // namespace fabseq
