// SPDX-License-Identifier: MIT
/// Random subproblems of MMA: the step must fulfil the optimality conditions of Svanberg's approximations,
/// which are written out here as in his papers (docs/developer/optimizer.md 9.1).
#include "fabseq/base/mpi.h"
#include "fabseq/mma/mma.h"
#include "support/share.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace fabseq {
namespace {

/// Numbers that are the same on all ranks.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low = 0.0, double high = 1.0) { return low + (high - low) * uniform_(engine_); }
  double normal() { return normal_(engine_); }
  /// 10^low to 10^high.
  double power(double low, double high) { return std::pow(10.0, uniform(low, high)); }
  std::size_t below(std::size_t limit) { return engine_() % limit; }
  bool happens(double probability) { return uniform() < probability; }

 private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::normal_distribution<double> normal_;
};

/// Ordinary constraints, least squares (pairs of rows +r, -r with c = 0), minimax (a > 0), or a mixture.
enum class Kind { constraints, least_squares, minimax, mixture };

MmaRows random_rows(Random& random, Kind kind, std::size_t m) {
  MmaRows rows;
  rows.add_constraints(m);
  for (std::size_t i = 0; i < m; ++i) {
    const bool residual = kind == Kind::least_squares || (kind == Kind::mixture && i % 2 == 1);
    rows.c[i] = residual ? 0.0 : random.power(1.0, 4.0);
    rows.d[i] = random.power(-1.0, 1.0);
    if (kind == Kind::minimax && random.happens(0.7)) rows.a[i] = random.uniform(0.5, 2.0);
  }
  return rows;
}

/// Bounds and a start, some variables at a bound and some fixed; whole.
struct Variables {
  Variables(Random& random, std::size_t n) : x(n), lower(n), upper(n) {
    for (std::size_t j = 0; j < n; ++j) {
      lower[j] = random.normal();
      upper[j] = random.happens(0.05) ? lower[j] : lower[j] + random.power(-1.0, 1.0);
      x[j] = lower[j] + std::clamp(random.uniform(-0.1, 1.1), 0.0, 1.0) * (upper[j] - lower[j]);
    }
  }
  std::vector<double> x, lower, upper;
};

struct Functions {
  std::vector<double> objective_gradient, values;
  std::vector<std::vector<double>> gradients;
};

/// Gradients of different sizes, dense or sparse, with or without a common sign; values such that some rows
/// cannot be met within a step of `move`.
Functions random_functions(Random& random, Kind kind, std::size_t n, std::size_t m, double move) {
  const double scale = random.power(-2.0, 2.0), offset = random.normal();
  const bool sparse = random.happens(0.3), positive = random.happens(0.3);
  Functions f{std::vector<double>(n), std::vector<double>(m), {}};
  if (kind != Kind::minimax || random.happens(0.7))
    for (double& entry : f.objective_gradient) entry = scale * random.normal();
  for (std::size_t i = 0; i < m; ++i) {
    const double size = random.power(-1.0, 1.0);
    std::vector<double>& gradient = f.gradients.emplace_back(n, 0.0);
    for (double& entry : gradient) {
      const double value = random.normal();
      if (!sparse || random.happens(0.2)) entry = size * (positive ? std::abs(value) : value);
    }
    f.values[i] = (offset + random.normal()) * size * random.power(-1.0, 1.0) * move;
    if (kind != Kind::least_squares || i % 2 == 0) continue;
    f.values[i] = -f.values[i - 1];
    for (std::size_t j = 0; j < n; ++j) gradient[j] = -f.gradients[i - 1][j];
  }
  return f;
}

/// p / (U - x) + q / (x - L) of one function in one variable, around `x0` (Svanberg 2007).
struct Approximation {
  Approximation(double slope, double x0_, double low_, double upp_, double range)
      : x0(x0_), low(low_), upp(upp_) {
    const double rise = std::max(slope, 0.0), fall = std::max(-slope, 0.0);
    p = (upp - x0) * (upp - x0) * (1.001 * rise + 0.001 * fall + 1e-5 / range);
    q = (x0 - low) * (x0 - low) * (0.001 * rise + 1.001 * fall + 1e-5 / range);
  }
  double value(double x) const { return p / (upp - x) + q / (x - low); }
  double rising(double x) const { return p / ((upp - x) * (upp - x)); }
  double falling(double x) const { return q / ((x - low) * (x - low)); }
  double x0, low, upp, p = 0.0, q = 0.0;
};

/// Violations of the optimality conditions, relative to the terms they consist of.
struct Violations {
  double gap = 0.0;    ///< what moving the variables within their bounds could still win
  double rows = 0.0;   ///< rows that are not fulfilled, and multipliers beyond their bounds
  double slack = 0.0;  ///< multipliers of rows with slack
  double largest() const { return std::max({gap, rows, slack}); }
};

/// `before` and `after`: this rank's x; the state is that after the update. Collective.
Violations violations(const test::Share& share, const Variables& start, const std::vector<double>& before,
                      const std::vector<double>& after, const Functions& f, const MmaRows& rows,
                      const Mma& mma, double move, const std::vector<double>& multipliers) {
  const std::size_t m = f.values.size();
  std::vector<double> sums(2 + 2 * m, 0.0);  // gap, size of its terms; change and size of each row
  for (std::size_t local = 0; local < share.size(); ++local) {
    const std::size_t j = share.begin + local;
    const double range = start.upper[j] - start.lower[j], x0 = before[local], x = after[local];
    if (range <= 0.0) {
      EXPECT_EQ(x, x0);
      continue;
    }
    const double low = mma.state().low[local], upp = mma.state().upp[local];
    const double alpha = std::max({start.lower[j], x0 - 0.9 * (x0 - low), x0 - move * range});
    const double beta = std::min({start.upper[j], x0 + 0.9 * (upp - x0), x0 + move * range});
    EXPECT_GE(x, alpha - 1e-12);
    EXPECT_LE(x, beta + 1e-12);
    double slope = 0.0, size = 0.0;
    for (std::size_t i = 0; i <= m; ++i) {
      const double derivative = i < m ? f.gradients[i][j] : f.objective_gradient[j];
      const double multiplier = i < m ? multipliers[i] : 1.0;
      const Approximation g(derivative, x0, low, upp, range);
      slope += multiplier * (g.rising(x) - g.falling(x));
      size += multiplier * (g.rising(x) + g.falling(x));
      if (i == m) continue;
      sums[2 + i] += g.value(x) - g.value(x0);
      sums[2 + m + i] += (beta - alpha) * std::abs(derivative);
    }
    sums[0] += slope > 0.0 ? slope * (x - alpha) : -slope * (beta - x);
    sums[1] += size * (beta - alpha);
  }
  sum_in_place(PETSC_COMM_WORLD, sums);

  Violations result;
  if (sums[1] > 0.0) result.gap = sums[0] / sums[1];
  double z = 0.0, pull = rows.a0, largest = 1.0;  // the smallest z that fulfils the rows, given y
  std::vector<double> relaxed(m);
  for (std::size_t i = 0; i < m; ++i) {
    relaxed[i] = f.values[i] + sums[2 + i] - std::max(0.0, (multipliers[i] - rows.c[i]) / rows.d[i]);
    if (rows.a[i] > 0.0) z = std::max(z, relaxed[i] / rows.a[i]);
    pull -= rows.a[i] * multipliers[i];
    largest = std::max(largest, std::abs(f.values[i]));
  }
  result.rows = std::max(0.0, -pull);
  result.slack = z * std::max(0.0, pull) / largest;
  for (std::size_t i = 0; i < m; ++i) {
    const double size = 1.0 + std::abs(f.values[i]) + sums[2 + m + i];
    const double value = (relaxed[i] - rows.a[i] * z) / size;
    result.rows = std::max({result.rows, value, -multipliers[i]});
    result.slack = std::max(result.slack, -value * std::min(1.0, multipliers[i]));
  }
  return result;
}

TEST(MmaSubproblem, StepsOfRandomProblemsAreOptimal) {
  constexpr unsigned problems = 150;
  for (unsigned seed = 0; seed < problems; ++seed) {
    Random random(seed);
    const std::size_t n = 1 + random.below(seed % 3 == 0 ? 6 : 200), m = random.below(25);
    const Kind kind = static_cast<Kind>(random.below(4));
    const double move = random.power(-3.0, 0.0);
    const Variables variables(random, n);
    const MmaRows rows = random_rows(random, kind, m);
    const test::Share share(PETSC_COMM_WORLD, n);
    std::vector<double> x = share.of(variables.x);
    Mma mma(PETSC_COMM_WORLD, share.size(), {});
    for (int update = 0; update < 3; ++update) {  // the third has asymptotes that moved
      const Functions f = random_functions(random, kind, n, m, move);
      std::vector<std::vector<double>> gradients;
      for (const auto& gradient : f.gradients) gradients.push_back(share.of(gradient));
      const std::vector<double> before = x;
      const MmaReport report = mma.update(x, share.of(f.objective_gradient), f.values, gradients,
                                          share.of(variables.lower), share.of(variables.upper), move, rows);
      const Violations found =
          violations(share, variables, before, x, f, rows, mma, move, report.multipliers);
      EXPECT_LT(found.largest(), 2e-6)  // where rounding stops Newton's method; most are at 1e-9
          << "seed " << seed << ", update " << update << ", kind " << static_cast<int>(kind) << ", n " << n
          << ", m " << m << ": gap " << found.gap << ", rows " << found.rows << ", slack " << found.slack;
    }
  }
}

}  // namespace
}  // namespace fabseq
