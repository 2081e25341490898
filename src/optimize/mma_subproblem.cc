#include "fabseq/optimize/mma_subproblem.h"

#include "fabseq/base/error.h"
#include "fabseq/optimize/mma_rows.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

extern "C" void dsymv_(const char* uplo, const int* n, const double* alpha, const double* a, const int* lda,
                       const double* x, const int* incx, const double* beta, double* y, const int* incy);

namespace fabseq {

namespace {

double P(const char* n, double d) { return std::getenv(n) ? std::atof(std::getenv(n)) : d; }
const double first_barrier = P("B0", 0.1), final_barrier = P("FB", 1e-9);
const double overshoot = P("OV", 0.5);
const int step_limit = 200, cut_limit = 20;

class Solver {
 public:
  Solver(MPI_Comm comm, MmaVariables& variables, std::span<const double> values, const MmaRows& rows)
      : comm_(comm),
        variables_(variables),
        values_(values),
        rows_(rows),
        m_(values.size()),
        lambda_(m_),
        direction_(m_),
        function_(m_) {}

  MmaReport solve();

 private:
  void start();
  void set_function(const MmaSums& sums);
  double residual() const;
  void set_direction(const std::vector<double>& matrix);
  double ascent() const;
  double elastic(std::size_t i) const {
    return rows_.d[i] > 0.0 ? std::max(0.0, lambda_[i] - rows_.c[i]) / rows_.d[i] : 0.0;
  }

  [[maybe_unused]] MPI_Comm comm_;
  MmaVariables& variables_;
  std::span<const double> values_;
  const MmaRows& rows_;
  std::size_t m_;
  double barrier_ = first_barrier, keep_ = P("KEEP", 0.01);
  std::vector<double> lambda_, direction_, function_;
  MmaMultipliers model_;
};

void Solver::start() {
  double pull = 0.0;
  for (std::size_t i = 0; i < m_; ++i) {
    const double c = rows_.c[i], d = rows_.d[i], f = values_[i];
    lambda_[i] = f > 0.0 ? std::min(c + d * f, std::max(1.0, d * f)) : 0.0;
    if (d <= 0.0) lambda_[i] = std::min(lambda_[i], c);
    pull += rows_.a[i] * lambda_[i];
  }
  if (pull > rows_.a0) {
    for (double& value : lambda_) value *= rows_.a0 / pull;
  }
  if (!variables_.start(lambda_)) throw NumericalError("MMA: a gradient is not finite");
}

void Solver::set_function(const MmaSums& sums) {
  for (std::size_t i = 0; i < m_; ++i) function_[i] = values_[i] + sums.change[i];
}

double Solver::residual() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < m_; ++i) {
    const double y = rows_.d[i] > 0.0 ? elastic(i) : model_.y[i];
    const double value = function_[i] - rows_.a[i] * model_.z - y;
    largest = std::max(largest, value > 0.0 ? value : -value * std::min(1.0, lambda_[i]));
  }
  return largest;
}

void Solver::set_direction(const std::vector<double>& matrix) {
  const auto m = static_cast<int>(m_), stride = m + 1;
  const int one = 1;
  const double plus = 1.0;
  std::vector<double> right = function_, from(m_), step(m_);
  const double keep = keep_;
  MmaRows shifted = rows_;
  for (std::size_t i = 0; i < m_; ++i) {
    from[i] = keep * lambda_[i];
    step[i] = lambda_[i] - from[i];
    shifted.a0 -= rows_.a[i] * from[i];
    if (rows_.c[i] > 0.0) {
      from[i] = std::min(from[i], keep * rows_.c[i]);
      shifted.c[i] -= from[i];
    } else {
      right[i] -= from[i] / rows_.d[i];
    }
    step[i] = lambda_[i] - from[i];
  }
  dsymv_("L", &m, &plus, matrix.data(), &stride, step.data(), &one, &plus, right.data(), &one);
  model_ = solve_row_model(matrix, m_ + 1, right, shifted);
  for (std::size_t i = 0; i < m_; ++i) model_.lambda[i] += from[i];
  if (!model_.converged) std::printf("*** model not converged\n");
  for (std::size_t i = 0; i < m_; ++i) direction_[i] = model_.lambda[i] - lambda_[i];
}

// Derivative of the dual function along the direction.
double Solver::ascent() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < m_; ++i) sum += direction_[i] * (function_[i] - elastic(i));
  return sum;
}

MmaReport Solver::solve() {
  start();
  MmaReport report;
  const MmaSums* sums = &variables_.evaluate(0.0, barrier_);
  set_function(*sums);
  bool stale = false;
  while (m_ > 0) {
    std::vector<double> matrix = sums->schur;
    const std::vector<double> lambda = lambda_, base = function_;
    double before = 0.0, t = 1.0;
    bool first = true;
    double after1 = 0, rbase = residual();
    for (int cut = 0;; ++cut) {
      function_ = base;
      lambda_ = lambda;
      set_direction(matrix);
      before = ascent();
      variables_.set_direction(direction_);
      for (std::size_t i = 0; i < m_; ++i) lambda_[i] = lambda[i] + t * direction_[i];
      sums = &variables_.evaluate(t, barrier_);
      set_function(*sums);
      const double after = ascent();
      if (std::getenv("DBG"))
        std::printf("%d barrier %g t %g ascent %g to %g residual %g\n", report.newton_steps, barrier_, t,
                    before, after, residual());
      if (after >= -overshoot * std::abs(before) || cut == cut_limit || residual() <= 1e-9) break;
      first = false;
      if (stale) {
        t = 0.0;
        lambda_ = lambda;
        sums = &variables_.evaluate(0, barrier_);
        set_function(*sums);
        break;
      }
      static const double mode = P("MODE", 0);
      if (mode == 0)
        t *= std::clamp(before / (before - after), 0.1, 0.7);
      else if (mode == 1) {
        for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i] += sums->schur[i];
      } else {
        std::vector<double> u(m_);
        double dd = 0.0;
        for (std::size_t i = 0; i < m_; ++i) {
          double hd = 0.0;
          for (std::size_t k = 0; k < m_; ++k)
            hd += matrix[std::min(i, k) * (m_ + 1) + std::max(i, k)] * direction_[k];
          u[i] = base[i] - function_[i] - hd;
          dd += u[i] * direction_[i];
        }
        if (!(dd > 0)) std::printf("dd %g\n", dd);
        for (std::size_t i = 0; i < m_; ++i)
          for (std::size_t k = i; k < m_; ++k) matrix[i * (m_ + 1) + k] += u[i] * u[k] / dd;
      }
    }
    stale = false;
    variables_.advance(t);
    ++report.newton_steps;
    report.kkt_residual = residual();
    if (barrier_ <= final_barrier && report.kkt_residual <= 1e-9) break;
    if (report.newton_steps == step_limit) throw NumericalError("MMA: the subproblem does not converge");
    static const double kmin = P("KEEP", 0.01), kmax = P("KMAX", 0.9);
    if (P("RE",0) == 0) keep_ = first ? std::max(kmin, keep_ * keep_) : std::min(kmax, std::sqrt(keep_));
    else if (first) keep_ =  std::max(kmin, keep_ * keep_);
    static const double lowc = P("LC", 1e9);
    after1 = ascent();
    (void)rbase;
    if (t > 0.9 && first && std::abs(after1) <= lowc * std::abs(before)) {
      static const double fac = P("FAC", 0.1), ex = P("EX", 1.5);
      const double old = barrier_;
      barrier_ = std::max(final_barrier, std::min(fac * barrier_, std::pow(barrier_, ex)));
      stale = barrier_ != old;
      variables_.scale_ = variables_.free_ > 0 ? sums->slope / variables_.free_ : 1.0;
      if (P("PRED", 1))
        for (std::size_t i = 0; i < m_; ++i)
          function_[i] += (barrier_ - old) * (sums->wall[i] + sums->schur[i * (m_ + 1) + m_]);
    }
  }
  if (m_ == 0) variables_.evaluate(0.0, final_barrier);
  report.multipliers = lambda_;
  for (std::size_t i = 0; i < m_; ++i)
    report.largest_violation =
        std::max(report.largest_violation, rows_.d[i] > 0.0 ? elastic(i) : model_.y[i]);
  return report;
}

}  // namespace

MmaReport solve_mma_subproblem(MPI_Comm comm, MmaVariables& variables, std::span<const double> values,
                               const MmaRows& rows) {
  return Solver(comm, variables, values, rows).solve();
}

}  // namespace fabseq
