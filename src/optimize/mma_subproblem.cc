#include "fabseq/optimize/mma_subproblem.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotrs_(const char* uplo, const int* n, const int* nrhs, const double* a, const int* lda, double* b,
             const int* ldb, int* info);
}

namespace fabseq {

namespace {

double P(const char* n, double d) { return std::getenv(n) ? std::atof(std::getenv(n)) : d; }
const double final_barrier = P("FB", 1e-9);
const double centered = P("CE", 10.0);    // the barrier falls where all residuals are below this many barriers
const double to_the_boundary = P("TB", 0.99);
constexpr int step_limit = 300;
const int cut_limit = (int)P("CL", 8);

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

class Solver {
 public:
  Solver(MPI_Comm comm, MmaVariables& variables, std::span<const double> values, const MmaRows& rows)
      : comm_(comm), variables_(variables), values_(values), rows_(rows), m_(values.size()), lambda_(m_), slack_(m_),
        y_(m_), mu_(m_), y_direction_(m_), slack_direction_(m_), mu_direction_(m_), function_(m_), barrier_slope_(m_), lambda_direction_(m_) {
    has_z_ = std::any_of(rows.a.begin(), rows.a.end(), [](double a) { return a != 0.0; });
  }

  MmaReport solve();

 private:
  void start();
  double elastic(std::size_t i) const;
  void reset();
  void set_function(const MmaSums& sums);
  void take(const MmaSums& sums, double target);
  double residual() const;
  void lower_barrier();
  void set_direction(const MmaSums& sums);
  bool solve_rows(std::vector<double>& matrix, std::vector<double>& right) const;
  double room(double t_max) const;
  double ascent() const;
  const MmaSums& search();
  double zeta() const { return rows_.a0 - dot(rows_.a, lambda_); }

  MPI_Comm comm_;
  MmaVariables& variables_;
  std::span<const double> values_;
  const MmaRows& rows_;
  std::size_t m_;
  bool has_z_;
  double barrier_ = P("B0", 1.0);
  double target_ = 1.0;  // the variables' barrier at the last evaluation
  std::vector<double> lambda_, slack_, y_, mu_, y_direction_, slack_direction_, mu_direction_, function_, barrier_slope_, lambda_direction_;
  double z_ = 0.0, z_direction_ = 0.0;
};

void Solver::start() {
  for (std::size_t i = 0; i < m_; ++i) {
    const double c = rows_.c[i], d = rows_.d[i], f = values_[i];
    lambda_[i] = f > 0.0 ? std::min(c + d * f, std::max(1.0, d * f)) : 1.0 / (1.0 - f);
    if (d <= 0.0) lambda_[i] = std::min(lambda_[i], 0.5 * c);
  }
  if (has_z_) {
    const double pull = dot(rows_.a, lambda_);
    if (pull > 0.5 * rows_.a0) {
      for (double& value : lambda_) value *= 0.5 * rows_.a0 / pull;
    }
    z_ = barrier_ / zeta();
  }
  for (std::size_t i = 0; i < m_; ++i) slack_[i] = barrier_ / lambda_[i];
  if (!variables_.start(lambda_)) throw NumericalError("MMA: a gradient is not finite");
}

double Solver::elastic(std::size_t i) const {
  const double d = rows_.d[i], gap = rows_.c[i] - lambda_[i];
  const double root = std::sqrt(gap * gap + 4.0 * d * barrier_) + std::abs(gap);
  return gap > 0.0 ? 2.0 * barrier_ / root : root / (2.0 * d);
}

void Solver::reset() {
  for (std::size_t i = 0; i < m_; ++i) {
    y_[i] = elastic(i);
    mu_[i] = barrier_ / y_[i];
    slack_[i] = barrier_ / lambda_[i];
  }
  if (has_z_) z_ = barrier_ / zeta();
}

void Solver::set_function(const MmaSums& sums) {
  for (std::size_t i = 0; i < m_; ++i) {
    function_[i] = values_[i] + sums.change[i];
    barrier_slope_[i] = sums.wall[i] + sums.schur[i * (m_ + 1) + m_];
  }
  target_ = barrier_;
}

double Solver::residual() const {
  double largest = has_z_ ? std::abs(z_ * zeta() - barrier_) : 0.0;
  for (std::size_t i = 0; i < m_; ++i) {
    largest = std::max({largest, std::abs(function_[i] - rows_.a[i] * z_ - y_[i] + slack_[i]),
                        std::abs(lambda_[i] * slack_[i] - barrier_), std::abs(mu_[i] * y_[i] - barrier_),
                        std::abs(rows_.c[i] + rows_.d[i] * y_[i] - mu_[i] - lambda_[i])});
  }
  return largest;
}

void Solver::lower_barrier() {
  static const double fac = P("FAC", 0.1), ex = P("EX", 1.5);
  bool lowered = false;
  while (barrier_ > final_barrier && residual() <= centered * barrier_) {
    barrier_ = std::max(final_barrier, std::min(fac * barrier_, std::pow(barrier_, ex)));
    lowered = true;
  }
  if (!lowered) return;
  const double change = barrier_ - target_;
  if (P("PRED",1)) for (std::size_t i = 0; i < m_; ++i) function_[i] += change * barrier_slope_[i];
}

// Cholesky of the matrix scaled to a unit diagonal; should rounding have made it indefinite, with the diagonal raised.
bool Solver::solve_rows(std::vector<double>& matrix, std::vector<double>& right) const {
  const auto m = static_cast<int>(m_);
  const int columns = 2;
  std::vector<double> scale(m_), factor;
  for (std::size_t i = 0; i < m_; ++i) scale[i] = 1.0 / std::sqrt(matrix[i * m_ + i]);
  for (std::size_t column = 0; column < m_; ++column) {
    for (std::size_t row = column; row < m_; ++row) matrix[column * m_ + row] *= scale[column] * scale[row];
    right[column] *= scale[column];
    right[m_ + column] *= scale[column];
  }
  for (double raise = 0.0; raise < 1.0; raise = std::max(1e-14, 100.0 * raise)) {
    int info = 0;
    factor = matrix;
    for (std::size_t i = 0; i < m_; ++i) factor[i * m_ + i] += raise;
    dpotrf_("L", &m, factor.data(), &m, &info);
    if (info != 0) continue;
    dpotrs_("L", &m, &columns, factor.data(), &m, right.data(), &m, &info);
    for (std::size_t i = 0; i < m_; ++i) {
      right[i] *= scale[i];
      right[m_ + i] *= scale[i];
    }
    return true;
  }
  return false;
}

void Solver::set_direction(const MmaSums& sums) {
  std::vector<double> matrix(m_ * m_), right(2 * m_), y_diagonal(m_), y_right(m_);
  for (std::size_t i = 0; i < m_; ++i) {
    y_diagonal[i] = rows_.d[i] + mu_[i] / y_[i];
    y_right[i] = rows_.c[i] + rows_.d[i] * y_[i] - lambda_[i] - barrier_ / y_[i];
    for (std::size_t k = i; k < m_; ++k) matrix[i * m_ + k] = sums.schur[i * (m_ + 1) + k];
    matrix[i * m_ + i] += 1.0 / y_diagonal[i] + slack_[i] / lambda_[i];
    right[i] = function_[i] - rows_.a[i] * z_ - y_[i] + barrier_ / lambda_[i] + y_right[i] / y_diagonal[i];
    right[m_ + i] = rows_.a[i];
  }
  const bool solved = m_ == 0 || solve_rows(matrix, right);
  double dz = 0.0;
  if (has_z_) {
    double numerator = barrier_ / z_ - zeta(), denominator = zeta() / z_;
    for (std::size_t i = 0; i < m_; ++i) {
      numerator += rows_.a[i] * right[i];
      denominator += rows_.a[i] * right[m_ + i];
    }
    dz = numerator / denominator;
    for (std::size_t i = 0; i < m_; ++i) right[i] -= right[m_ + i] * dz;
  }
  // Ranks must not drift apart, on whatever processors they run: all follow rank 0.
  right.resize(m_ + 1);
  right[m_] = dz;
  if (!solved) std::fill(right.begin(), right.end(), std::numeric_limits<double>::quiet_NaN());
  MPI_Bcast(right.data(), static_cast<int>(m_ + 1), MPI_DOUBLE, 0, comm_);
  z_direction_ = right[m_];
  for (std::size_t i = 0; i < m_; ++i) {
    lambda_direction_[i] = right[i];
    if (lambda_[i] < rows_.c[i]) {
      double cap = rows_.d[i] > 0 ? rows_.c[i] + rows_.d[i] * std::max(0.0, function_[i] - rows_.a[i] * z_) : lambda_[i] + 0.99 * (rows_.c[i] - lambda_[i]);
      lambda_direction_[i] = std::min(lambda_direction_[i], cap - lambda_[i]);
    }
    if (P("LOW", 1)) lambda_direction_[i] = std::max(lambda_direction_[i], -to_the_boundary * lambda_[i]);
    y_direction_[i] = (lambda_direction_[i] - y_right[i]) / y_diagonal[i];
    mu_direction_[i] = (barrier_ - mu_[i] * y_direction_[i]) / y_[i] - mu_[i];
    slack_direction_[i] = (barrier_ - slack_[i] * lambda_direction_[i]) / lambda_[i] - slack_[i];
  }
}

// Derivative of the barrier function of the multipliers along the direction.
double Solver::ascent() const {
  const double z = has_z_ ? barrier_ / zeta() : 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < m_; ++i) {
    sum += lambda_direction_[i] * (function_[i] - rows_.a[i] * z - elastic(i) + barrier_ / lambda_[i]);
  }
  return sum;
}

const MmaSums& Solver::search() {
  double rate = 0.0;
  for (std::size_t i = 0; i < m_; ++i) rate = std::max(rate, -lambda_direction_[i] / lambda_[i]);
  if (has_z_) rate = std::max(rate, dot(rows_.a, lambda_direction_) / zeta());
  double t = std::min(1.0, to_the_boundary / rate);
  variables_.set_direction(lambda_direction_);
  const std::vector<double> lambda = lambda_;
  const double before = ascent();
  for (int cut = 0;; ++cut) {
    for (std::size_t i = 0; i < m_; ++i) lambda_[i] = lambda[i] + t * lambda_direction_[i];
    const MmaSums& sums = variables_.evaluate(t, barrier_);
    set_function(sums);
    const double after = ascent();
    static const double over = P("OV", 0.5);
    if (after >= -over * std::abs(before) || cut == cut_limit) {
      variables_.advance(t);
      const auto follow = [t](double& value, double direction) {
        value = std::max(value + t * direction, (1.0 - to_the_boundary) * value);
      };
      for (std::size_t i = 0; i < m_; ++i) {
        follow(y_[i], y_direction_[i]);
        follow(mu_[i], mu_direction_[i]);
        follow(slack_[i], slack_direction_[i]);
      }
      if (has_z_) follow(z_, z_direction_);
      if (std::getenv("DBG")) std::printf("      t %g ascent %g to %g\n", t, before, after);
      return sums;
    }
    if (std::getenv("DBG")) std::printf("   reject t %g ascent %g to %g\n", t, before, after);
    t *= std::clamp(before / (before - after), 0.1, 0.7);
  }
}

MmaReport Solver::solve() {
  start();
  MmaReport report;
  const MmaSums* sums = &variables_.evaluate(0.0, barrier_);
  set_function(*sums);
  reset();
  for (;; ++report.newton_steps) {
    lower_barrier();
    report.kkt_residual = residual();
    if (barrier_ <= final_barrier && report.kkt_residual <= final_barrier && report.newton_steps > 0) break;
    if (report.newton_steps == step_limit) throw NumericalError("MMA: the subproblem does not converge");
    set_direction(*sums);
    if (std::getenv("DBG")) std::printf("%d barrier %g residual %g \n", report.newton_steps, barrier_, report.kkt_residual);
    sums = &search();
  }
  report.multipliers = lambda_;
  for (const double y : y_) report.largest_violation = std::max(report.largest_violation, y);
  return report;
}

}  // namespace

MmaReport solve_mma_subproblem(MPI_Comm comm, MmaVariables& variables, std::span<const double> values,
                               const MmaRows& rows) {
  return Solver(comm, variables, values, rows).solve();
}

}  // namespace fabseq
