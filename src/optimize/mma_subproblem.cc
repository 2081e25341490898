#include "fabseq/optimize/mma_subproblem.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>

extern "C" {
void dsyrk_(const char* uplo, const char* transpose, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* beta, double* c, const int* ldc);
void dsysv_(const char* uplo, const int* n, const int* right_sides, double* a, const int* lda, int* pivots,
            double* b, const int* ldb, double* work, const int* work_size, int* info);
}

namespace fabseq {

namespace {

constexpr double last_relaxation = 1e-9;
constexpr int step_limit = 100;  ///< at one relaxation; then the next is tried all the same
constexpr int cut_limit = 40;
constexpr double to_boundary =
    1.01;  ///< a step goes at most 1 / 1.01 of the way to where a positive quantity vanishes

/// Everything that has an entry a row, and z.
struct RowState {
  std::vector<double> y, lambda, mu, s;
  double z = 1.0, zeta = 1.0;
};

/// Everything that has an entry a free variable of this rank.
struct VariableState {
  std::vector<double> v, xi, eta;
};

class InteriorPoint {
 public:
  InteriorPoint(MPI_Comm comm, const MmaBox& box, std::span<const double> objective_gradient,
                std::span<const double> values, std::span<const std::span<const double>> gradients,
                const MmaRows& rows);

  std::vector<double> solve(MmaReport& report);

 private:
  struct Norms {
    double square = 0.0, largest = 0.0;
  };
  void start();
  Norms residual(double relaxation);
  void newton_direction(double relaxation);
  std::vector<double> schur_system(double relaxation);
  double longest_step() const;
  void move(const VariableState& variables, const RowState& rows, double step);

  MPI_Comm comm_;
  std::size_t local_, n_ = 0, m_;
  std::vector<std::size_t> free_;                     ///< local index of each free variable
  std::vector<double> upper_, lower_, alpha_, beta_;  ///< of the free variables
  std::vector<double> p0_, q0_, p_, q_, b_;           ///< p_, q_: [variable][row]
  MmaRows rows_;
  VariableState x_, dx_;
  RowState r_, dr_;
  std::vector<double> diagonal_, right_, slopes_;  ///< of the current step; slopes_: [variable][row]
  std::vector<double> g_;                          ///< the rows' approximations without b
};

InteriorPoint::InteriorPoint(MPI_Comm comm, const MmaBox& box, std::span<const double> objective_gradient,
                             std::span<const double> values,
                             std::span<const std::span<const double>> gradients, const MmaRows& rows)
    : comm_(comm),
      local_(box.size()),
      m_(values.size()),
      b_(values.size(), 0.0),
      rows_(rows),
      g_(values.size()) {
  for (std::size_t j = 0; j < local_; ++j)
    if (box.width[j] > 0.0) free_.push_back(j);
  n_ = free_.size();
  p0_.resize(n_);
  q0_.resize(n_);
  p_.resize(n_ * m_);
  q_.resize(n_ * m_);
  slopes_.resize(n_ * m_);
  for (std::size_t k = 0; k < n_; ++k) {
    const std::size_t j = free_[k];
    upper_.push_back(box.upper_distance[j]);
    lower_.push_back(box.lower_distance[j]);
    alpha_.push_back(box.alpha[j]);
    beta_.push_back(box.beta[j]);
    const MmaApproximation objective(box, j, objective_gradient[j]);
    p0_[k] = objective.p;
    q0_[k] = objective.q;
    for (std::size_t i = 0; i < m_; ++i) {
      const MmaApproximation row(box, j, gradients[i][j]);
      p_[k * m_ + i] = row.p;
      q_[k * m_ + i] = row.q;
      b_[i] += row.value(0.0);
    }
  }
  sum_in_place(comm_, b_);
  for (std::size_t i = 0; i < m_; ++i) b_[i] -= values[i];
}

void InteriorPoint::start() {
  x_.v.resize(n_);
  x_.xi.resize(n_);
  x_.eta.resize(n_);
  for (std::size_t k = 0; k < n_; ++k) {
    x_.v[k] = 0.5 * (alpha_[k] + beta_[k]);
    x_.xi[k] = std::max(1.0, 1.0 / (x_.v[k] - alpha_[k]));
    x_.eta[k] = std::max(1.0, 1.0 / (beta_[k] - x_.v[k]));
  }
  r_.y.assign(m_, 1.0);
  r_.lambda.assign(m_, 1.0);
  r_.s.assign(m_, 1.0);
  for (std::size_t i = 0; i < m_; ++i) r_.mu.push_back(std::max(1.0, 0.5 * rows_.c[i]));
  dx_ = x_;
  dr_ = r_;
  diagonal_.resize(n_);
  right_.resize(n_);
}

/// Norms of the relaxed optimality conditions, over all ranks; leaves the rows' values in g_.
InteriorPoint::Norms InteriorPoint::residual(double relaxation) {
  std::vector<double> sums(m_ + 1, 0.0);
  double largest = 0.0;
  double square = 0.0;
  const auto count = [&](double value) {
    square += value * value;
    largest = std::max(largest, std::abs(value));
  };
  for (std::size_t k = 0; k < n_; ++k) {
    const double above = 1.0 / (upper_[k] - x_.v[k]);
    const double below = 1.0 / (x_.v[k] + lower_[k]);
    double p = p0_[k];
    double q = q0_[k];
    for (std::size_t i = 0; i < m_; ++i) {
      p += r_.lambda[i] * p_[k * m_ + i];
      q += r_.lambda[i] * q_[k * m_ + i];
      sums[i] += p_[k * m_ + i] * above + q_[k * m_ + i] * below;
    }
    count(p * above * above - q * below * below - x_.xi[k] + x_.eta[k]);
    count(x_.xi[k] * (x_.v[k] - alpha_[k]) - relaxation);
    count(x_.eta[k] * (beta_[k] - x_.v[k]) - relaxation);
  }
  sums[m_] = square;
  sum_in_place(comm_, sums);
  largest = max(comm_, largest);
  square = sums[m_];
  std::copy(sums.begin(), sums.end() - 1, g_.begin());
  double pull = rows_.a0 - r_.zeta;
  for (std::size_t i = 0; i < m_; ++i) {
    pull -= rows_.a[i] * r_.lambda[i];
    count(rows_.c[i] + rows_.d[i] * r_.y[i] - r_.mu[i] - r_.lambda[i]);
    count(g_[i] - rows_.a[i] * r_.z - r_.y[i] + r_.s[i] - b_[i]);
    count(r_.mu[i] * r_.y[i] - relaxation);
    count(r_.lambda[i] * r_.s[i] - relaxation);
  }
  count(pull);
  count(r_.zeta * r_.z - relaxation);
  return {square, largest};
}

/// G D^-1 G^T (lower triangle, by columns) and G D^-1 r, summed over the ranks, with G the rows' slopes, D the variables'
/// diagonal and r their residual. Leaves G, D and r of this rank for the back substitution.
std::vector<double> InteriorPoint::schur_system(double relaxation) {
  std::vector<double> scaled(n_ * m_);
  std::vector<double> sums(m_ * m_ + m_, 0.0);
  for (std::size_t k = 0; k < n_; ++k) {
    const double above = 1.0 / (upper_[k] - x_.v[k]);
    const double below = 1.0 / (x_.v[k] + lower_[k]);
    const double above_square = above * above;
    const double below_square = below * below;
    double p = p0_[k];
    double q = q0_[k];
    double* slope = &slopes_[k * m_];
    for (std::size_t i = 0; i < m_; ++i) {
      p += r_.lambda[i] * p_[k * m_ + i];
      q += r_.lambda[i] * q_[k * m_ + i];
      slope[i] = p_[k * m_ + i] * above_square - q_[k * m_ + i] * below_square;
    }
    const double from_alpha = x_.v[k] - alpha_[k];
    const double to_beta = beta_[k] - x_.v[k];
    diagonal_[k] = 2.0 * (p * above_square * above + q * below_square * below) + x_.xi[k] / from_alpha +
                   x_.eta[k] / to_beta;
    right_[k] = p * above_square - q * below_square - relaxation / from_alpha + relaxation / to_beta;
    const double root = 1.0 / std::sqrt(diagonal_[k]);
    for (std::size_t i = 0; i < m_; ++i) {
      scaled[k * m_ + i] = slope[i] * root;
      sums[m_ * m_ + i] += slope[i] * right_[k] / diagonal_[k];
    }
  }
  const auto m = static_cast<int>(m_);
  const auto n = static_cast<int>(n_);
  const double one = 1.0;
  const double zero = 0.0;
  if (m > 0 && n > 0) dsyrk_("L", "N", &m, &n, &one, scaled.data(), &m, &zero, sums.data(), &m);
  sum_in_place(comm_, sums);
  return sums;
}

void InteriorPoint::newton_direction(double relaxation) {
  const std::vector<double> sums = schur_system(relaxation);
  const auto size = static_cast<int>(m_) + 1;
  const int one = 1;
  std::vector<double> matrix(static_cast<std::size_t>(size) * size, 0.0);
  std::vector<double> solution(size);
  std::vector<double> y_residual(m_), y_diagonal(m_);
  double z_residual = rows_.a0 - relaxation / r_.z;
  for (std::size_t i = 0; i < m_; ++i) {
    z_residual -= rows_.a[i] * r_.lambda[i];
    y_residual[i] = rows_.c[i] + rows_.d[i] * r_.y[i] - r_.lambda[i] - relaxation / r_.y[i];
    y_diagonal[i] = rows_.d[i] + r_.mu[i] / r_.y[i];
    const double row_residual = g_[i] - rows_.a[i] * r_.z - r_.y[i] - b_[i] + relaxation / r_.lambda[i];
    solution[i] = row_residual + y_residual[i] / y_diagonal[i] - sums[m_ * m_ + i];
    for (std::size_t j = i; j < m_; ++j) matrix[i * size + j] = sums[i * m_ + j];
    matrix[i * size + i] += r_.s[i] / r_.lambda[i] + 1.0 / y_diagonal[i];
    matrix[i * size + m_] = rows_.a[i];
  }
  matrix[m_ * size + m_] = -r_.zeta / r_.z;
  solution[m_] = z_residual;
  std::vector<int> pivots(size);
  const int work_size = 64 * size;
  std::vector<double> work(work_size);
  int info = 0;
  dsysv_("L", &size, &one, matrix.data(), &size, pivots.data(), solution.data(), &size, work.data(),
         &work_size, &info);
  // Ranks must not drift apart, on whatever processors they run.
  MPI_Bcast(solution.data(), size, MPI_DOUBLE, 0, comm_);
  const bool finite =
      std::all_of(solution.begin(), solution.end(), [](double value) { return std::isfinite(value); });
  if (any(comm_, info != 0 || !finite))
    throw NumericalError("MMA: the equations of the subproblem have no solution");

  for (std::size_t i = 0; i < m_; ++i) {
    dr_.lambda[i] = solution[i];
    dr_.y[i] = (solution[i] - y_residual[i]) / y_diagonal[i];
    dr_.mu[i] = -r_.mu[i] + (relaxation - r_.mu[i] * dr_.y[i]) / r_.y[i];
    dr_.s[i] = -r_.s[i] + (relaxation - r_.s[i] * dr_.lambda[i]) / r_.lambda[i];
  }
  dr_.z = solution[m_];
  dr_.zeta = -r_.zeta + (relaxation - r_.zeta * dr_.z) / r_.z;
  for (std::size_t k = 0; k < n_; ++k) {
    double change = -right_[k];
    for (std::size_t i = 0; i < m_; ++i) change -= slopes_[k * m_ + i] * solution[i];
    change /= diagonal_[k];
    dx_.v[k] = change;
    dx_.xi[k] = -x_.xi[k] + (relaxation - x_.xi[k] * change) / (x_.v[k] - alpha_[k]);
    dx_.eta[k] = -x_.eta[k] + (relaxation + x_.eta[k] * change) / (beta_[k] - x_.v[k]);
  }
}

/// The step that keeps everything positive, at most 1.
double InteriorPoint::longest_step() const {
  double inverse = 1.0;
  const auto keep = [&](double value, double change) {
    inverse = std::max(inverse, -to_boundary * change / value);
  };
  for (std::size_t k = 0; k < n_; ++k) {
    keep(x_.xi[k], dx_.xi[k]);
    keep(x_.eta[k], dx_.eta[k]);
    keep(x_.v[k] - alpha_[k], dx_.v[k]);
    keep(beta_[k] - x_.v[k], -dx_.v[k]);
  }
  for (std::size_t i = 0; i < m_; ++i) {
    keep(r_.y[i], dr_.y[i]);
    keep(r_.lambda[i], dr_.lambda[i]);
    keep(r_.mu[i], dr_.mu[i]);
    keep(r_.s[i], dr_.s[i]);
  }
  keep(r_.z, dr_.z);
  keep(r_.zeta, dr_.zeta);
  return 1.0 / max(comm_, inverse);
}

void InteriorPoint::move(const VariableState& variables, const RowState& rows, double step) {
  for (std::size_t k = 0; k < n_; ++k) {
    x_.v[k] = variables.v[k] + step * dx_.v[k];
    x_.xi[k] = variables.xi[k] + step * dx_.xi[k];
    x_.eta[k] = variables.eta[k] + step * dx_.eta[k];
  }
  for (std::size_t i = 0; i < m_; ++i) {
    r_.y[i] = rows.y[i] + step * dr_.y[i];
    r_.lambda[i] = rows.lambda[i] + step * dr_.lambda[i];
    r_.mu[i] = rows.mu[i] + step * dr_.mu[i];
    r_.s[i] = rows.s[i] + step * dr_.s[i];
  }
  r_.z = rows.z + step * dr_.z;
  r_.zeta = rows.zeta + step * dr_.zeta;
}

std::vector<double> InteriorPoint::solve(MmaReport& report) {
  start();
  Norms norms;
  for (double relaxation = 1.0; relaxation >= 0.9 * last_relaxation; relaxation *= 0.1) {
    norms = residual(relaxation);
    if (!std::isfinite(norms.square)) throw NumericalError("MMA: a gradient is not finite");
    for (int newton = 0; newton < step_limit && norms.largest > 0.9 * relaxation; ++newton) {
      newton_direction(relaxation);
      ++report.newton_steps;
      const VariableState variables = x_;
      const RowState rows = r_;
      double step = longest_step();
      const double before = norms.square;
      for (int cut = 0; cut < cut_limit; ++cut, step *= 0.5) {
        move(variables, rows, step);
        norms = residual(relaxation);
        if (norms.square < before) break;
      }
    }
  }
  report.kkt_residual = norms.largest;
  report.multipliers = r_.lambda;
  report.largest_violation = m_ > 0 ? *std::max_element(r_.y.begin(), r_.y.end()) : 0.0;
  std::vector<double> result(local_, 0.0);
  for (std::size_t k = 0; k < n_; ++k) result[free_[k]] = x_.v[k];
  return result;
}

}  // namespace

MmaApproximation::MmaApproximation(const MmaBox& box, std::size_t variable, double gradient)
    : upper(box.upper_distance[variable]), lower(box.lower_distance[variable]) {
  const double width = box.width[variable];
  const double rise = std::max(gradient, 0.0);
  const double fall = std::max(-gradient, 0.0);
  p = width * upper * upper * (1.001 * rise + 0.001 * fall + box.curvature[variable]);
  q = width * lower * lower * (0.001 * rise + 1.001 * fall + box.curvature[variable]);
}

MmaBox::MmaBox(std::size_t local)
    : width(local, 0.0),
      upper_distance(local, 1.0),
      lower_distance(local, 1.0),
      alpha(local, 0.0),
      beta(local, 0.0),
      curvature(local, 0.0) {}

std::vector<double> solve_mma_subproblem(MPI_Comm comm, const MmaBox& box,
                                         std::span<const double> objective_gradient,
                                         std::span<const double> values,
                                         std::span<const std::span<const double>> gradients,
                                         const MmaRows& rows, MmaReport& report) {
  return InteriorPoint(comm, box, objective_gradient, values, gradients, rows).solve(report);
}

}  // namespace fabseq
