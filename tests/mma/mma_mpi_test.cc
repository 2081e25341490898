// SPDX-License-Identifier: MIT
/// The method of moving asymptotes on problems whose solutions are known.
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/mma/mma.h"
#include "support/share.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace fabseq {
namespace {

using test::Share;
using test::whole_vector;

/// Values and gradients of all functions at a point known on every rank.
struct Evaluation {
  std::vector<double> objective_gradient;
  std::vector<double> values;
  std::vector<std::vector<double>> gradients;
};
using Function = std::function<Evaluation(const std::vector<double>&)>;

struct Problem {
  Function function;
  std::vector<double> start, lower, upper;
  MmaRows rows;
  double move_limit = 1.0;
  int iterations = 60;
  MmaSettings settings{};
};

std::vector<double> minimize(MPI_Comm comm, const Problem& problem, MmaReport* report = nullptr) {
  const std::size_t count = problem.start.size();
  const Share share(comm, count);
  std::vector<double> x = share.of(problem.start);
  const std::vector<double> lower = share.of(problem.lower), upper = share.of(problem.upper);
  Mma mma(comm, x.size(), problem.settings);
  for (int iteration = 0; iteration < problem.iterations; ++iteration) {
    const Evaluation e = problem.function(whole_vector(comm, share, x, count));
    std::vector<std::vector<double>> gradients;
    for (const auto& gradient : e.gradients) gradients.push_back(share.of(gradient));
    const MmaReport last = mma.update(x, share.of(e.objective_gradient), e.values, gradients, lower, upper,
                                      problem.move_limit, problem.rows);
    if (report != nullptr) *report = last;
  }
  return whole_vector(comm, share, x, count);
}

/// Svanberg 1987: weight of a cantilever of five hollow beams under a limit on its tip deflection.
Problem cantilever() {
  Problem problem;
  problem.start.assign(5, 5.0);
  problem.lower.assign(5, 1.0);
  problem.upper.assign(5, 10.0);
  problem.rows.add_constraints(1);
  problem.function = [](const std::vector<double>& x) {
    const std::vector<double> c = {61, 37, 19, 7, 1};
    Evaluation e;
    e.objective_gradient.assign(5, 0.0624);
    e.values = {-1.0};
    e.gradients.resize(1);
    for (int j = 0; j < 5; ++j) {
      e.values[0] += c[j] / std::pow(x[j], 3);
      e.gradients[0].push_back(-3.0 * c[j] / std::pow(x[j], 4));
    }
    return e;
  };
  return problem;
}

TEST(Mma, SolvesTheCantilever) {
  const std::vector<double> x = minimize(PETSC_COMM_WORLD, cantilever());
  double weight = 0.0;
  for (const double value : x) weight += 0.0624 * value;
  EXPECT_NEAR(weight, 1.33996, 5e-6);
  EXPECT_NEAR(x[0], 6.016, 2e-3);
  EXPECT_NEAR(x[4], 2.153, 2e-3);
}

TEST(Mma, SolvesTheTwoBarTruss) {
  Problem problem;
  problem.start = {1.5, 0.5};
  problem.lower = {0.2, 0.1};
  problem.upper = {4.0, 1.6};
  problem.rows.add_constraints(2);
  problem.function = [](const std::vector<double>& x) {
    const double root = std::sqrt(1.0 + x[1] * x[1]);
    const double slope = x[1] / root;
    Evaluation e;
    e.objective_gradient = {root, x[0] * slope};
    for (const double sign : {1.0, -1.0}) {
      const double term = 8.0 / x[0] + sign / (x[0] * x[1]);
      e.values.push_back(0.124 * root * term - 1.0);
      e.gradients.push_back(
          {-0.124 * root * term / x[0], 0.124 * (slope * term - root * sign / (x[0] * x[1] * x[1]))});
    }
    return e;
  };
  const std::vector<double> x = minimize(PETSC_COMM_WORLD, problem);
  EXPECT_NEAR(x[0] * std::sqrt(1.0 + x[1] * x[1]), 1.509, 1e-3);
  EXPECT_NEAR(x[0], 1.41, 5e-3);
  EXPECT_NEAR(x[1], 0.377, 5e-3);
}

/// min |A x - b|^2 with a pair of rows +r, -r a residual (c = 0, d = 2): MMA sees the curvature.
TEST(Mma, SolvesLeastSquares) {
  const std::vector<std::vector<double>> a = {{2, 1, 0}, {1, -1, 1}, {0, 3, 1}, {1, 1, 1}};
  const std::vector<double> b = {1, 2, -1, 0.5};
  Problem problem;
  problem.start = {0.0, 0.0, 0.0};
  problem.lower.assign(3, -5.0);
  problem.upper.assign(3, 5.0);
  problem.rows.add_residuals(4);
  problem.iterations = 150;
  problem.settings.asymptote_floor = 1e-3;
  problem.function = [&](const std::vector<double>& x) {
    Evaluation e;
    e.objective_gradient.assign(3, 0.0);
    for (const double sign : {1.0, -1.0})
      for (std::size_t i = 0; i < 4; ++i) {
        double residual = -b[i];
        for (std::size_t j = 0; j < 3; ++j) residual += a[i][j] * x[j];
        e.values.push_back(sign * residual);
        e.gradients.push_back(a[i]);
        for (double& entry : e.gradients.back()) entry *= sign;
      }
    return e;
  };
  const std::vector<double> x = minimize(PETSC_COMM_WORLD, problem);
  // Normal equations: A^T (A x - b) = 0.
  for (std::size_t j = 0; j < 3; ++j) {
    double gradient = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      double residual = -b[i];
      for (std::size_t k = 0; k < 3; ++k) residual += a[i][k] * x[k];
      gradient += a[i][j] * residual;
    }
    EXPECT_NEAR(gradient, 0.0, 2e-4);
  }
}

/// min sum w / x under 60 linear rows of which few matter; the optimality conditions are checked from
/// outside.
Problem many_constraints() {
  constexpr std::size_t n = 400, m = 60;
  Problem problem;
  problem.start.assign(n, 1.0);
  problem.lower.assign(n, 0.1);
  problem.upper.assign(n, 3.0);
  problem.rows.add_constraints(m);
  problem.iterations = 60;
  problem.function = [](const std::vector<double>& x) {
    Evaluation e;
    for (std::size_t j = 0; j < n; ++j)
      e.objective_gradient.push_back(-(1.0 + 0.5 * std::sin(1.0 * j)) / (x[j] * x[j]));
    for (std::size_t i = 0; i < m; ++i) {
      const double limit = i < 3 ? 1.0 : 5.0;
      double value = -limit;
      std::vector<double> gradient;
      for (std::size_t j = 0; j < n; ++j) {
        gradient.push_back((1.0 + std::cos(0.1 * (i + 1) * j)) / n);
        value += gradient.back() * x[j];
      }
      e.values.push_back(value);
      e.gradients.push_back(gradient);
    }
    return e;
  };
  return problem;
}

TEST(Mma, FindsFewActiveRowsAmongMany) {
  const Problem problem = many_constraints();
  MmaReport report;
  const std::vector<double> x = minimize(PETSC_COMM_WORLD, problem, &report);
  const Evaluation e = problem.function(x);
  EXPECT_LT(*std::max_element(e.values.begin(), e.values.end()), 1e-6);
  for (std::size_t i = 0; i < e.values.size(); ++i)
    EXPECT_LT(std::abs(report.multipliers[i] * e.values[i]), 1e-3);
  for (std::size_t i = 3; i < e.values.size(); ++i) EXPECT_LT(report.multipliers[i], 1e-6);
  for (std::size_t j = 0; j < x.size(); ++j) {
    if (x[j] < 0.1 + 1e-6 || x[j] > 3.0 - 1e-6) continue;
    double gradient = e.objective_gradient[j];
    for (std::size_t i = 0; i < e.values.size(); ++i) gradient += report.multipliers[i] * e.gradients[i][j];
    EXPECT_NEAR(gradient, 0.0, 1e-3);
  }
}

TEST(Mma, GivesTheSameIteratesOnAnyNumberOfRanks) {
  for (Problem problem : {cantilever(), many_constraints()}) {
    problem.iterations = 20;
    const std::vector<double> together = minimize(PETSC_COMM_WORLD, problem);
    const std::vector<double> alone = minimize(PETSC_COMM_SELF, problem);
    for (std::size_t j = 0; j < alone.size(); ++j) EXPECT_NEAR(together[j], alone[j], 1e-9);
  }
}

/// min max(f_1, f_2) of two parabolas: a = 1, c large, in the variable z.
TEST(Mma, SolvesMinimax) {
  Problem problem;
  problem.start = {2.0};
  problem.lower = {-4.0};
  problem.upper = {4.0};
  problem.rows.add_largest_of(2);
  problem.function = [](const std::vector<double>& x) {
    Evaluation e;
    e.objective_gradient = {0.0};
    for (const double center : {-1.0, 2.0}) {
      e.values.push_back((x[0] - center) * (x[0] - center));
      e.gradients.push_back({2.0 * (x[0] - center)});
    }
    return e;
  };
  EXPECT_NEAR(minimize(PETSC_COMM_WORLD, problem)[0], 0.5, 1e-4);
}

TEST(Mma, WorksWithoutRows) {
  Problem problem;
  problem.start = {0.5, 0.5};
  problem.lower = {0.0, 0.0};
  problem.upper = {1.0, 1.0};
  problem.settings.asymptote_floor = 1e-3;
  problem.function = [](const std::vector<double>& x) {
    Evaluation e;
    e.objective_gradient = {2.0 * (x[0] - 0.3), 1.0};
    return e;
  };
  const std::vector<double> x = minimize(PETSC_COMM_WORLD, problem);
  EXPECT_NEAR(x[0], 0.3, 1e-3);
  EXPECT_NEAR(x[1], 0.0, 1e-6);
}

TEST(Mma, RelaxesRowsThatCannotBeFulfilledAtOnce) {
  Problem problem = cantilever();
  problem.start.assign(5, 1.5);  // deflection far beyond the limit
  problem.move_limit = 0.02;
  problem.iterations = 1;
  MmaReport report;
  (void)minimize(PETSC_COMM_WORLD, problem, &report);
  EXPECT_GT(report.largest_violation, 1.0);
  problem.move_limit = 1.0;
  problem.iterations = 60;
  const std::vector<double> x = minimize(PETSC_COMM_WORLD, problem);
  double weight = 0.0;
  for (const double value : x) weight += 0.0624 * value;
  EXPECT_NEAR(weight, 1.33996, 5e-6);
}

TEST(Mma, KeepsMoveLimitBoundsAndFixedVariables) {
  Problem problem = cantilever();
  problem.lower[2] = problem.upper[2] = problem.start[2];
  problem.move_limit = 0.01;
  problem.iterations = 1;
  const std::vector<double> x = minimize(PETSC_COMM_WORLD, problem);
  EXPECT_EQ(x[2], problem.start[2]);
  for (std::size_t j = 0; j < 5; ++j) EXPECT_LE(std::abs(x[j] - problem.start[j]), 0.01 * 9.0 + 1e-12);
}

TEST(Mma, RefusesNumbersThatAreNone) {
  const Share share(PETSC_COMM_WORLD, 4);
  std::vector<double> x(share.size(), 0.5);
  const std::vector<double> lower(x.size(), 0.0), upper(x.size(), 1.0);
  std::vector<double> gradient(x.size(), 1.0);
  if (share.begin == 0 && !gradient.empty()) gradient[0] = std::numeric_limits<double>::quiet_NaN();
  Mma mma(PETSC_COMM_WORLD, x.size(), {});
  const std::vector<std::vector<double>> rows = {std::vector<double>(x.size(), 1.0)};
  const std::vector<double> values = {-1.0};
  MmaRows constraint;
  constraint.add_constraints(1);
  EXPECT_THROW(mma.update(x, gradient, values, rows, lower, upper, 0.1, constraint), NumericalError);
}

}  // namespace
}  // namespace fabseq
