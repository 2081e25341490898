#include "fabseq/optimize/mma_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotrs_(const char* uplo, const int* n, const int* nrhs, const double* a, const int* lda, double* b,
             const int* ldb, int* info);
void dsymv_(const char* uplo, const int* n, const double* alpha, const double* a, const int* lda,
            const double* x, const int* incx, const double* beta, double* y, const int* incy);
}

namespace fabseq {

namespace {

constexpr int step_limit = 100;
constexpr double product_tolerance = 1e-14, residual_tolerance = 1e-12;  // over the size of b
constexpr double to_the_boundary = 0.995;                                // fraction of the way
constexpr double neighborhood = 1e-4;                                    // least product over the mean
constexpr double far_residual = 1e-6, long_step = 0.3;
constexpr double rounding = 1e-15;
constexpr double least_size = 1e-8;  // of a start value

// Everything that must stay positive, and its directions: row i has lambda, s, y, mu = c + d y - lambda; then
// z, zeta.
struct Point {
  std::vector<double> lambda, slack, y, mu;
  double z = 0.0, zeta = 0.0;

  explicit Point(std::size_t m) : lambda(m), slack(m), y(m), mu(m) {}

  template <class Visit>
  void visit(const Point& other, Visit&& visit_pair) {
    for (std::size_t i = 0; i < lambda.size(); ++i) {
      visit_pair(lambda[i], other.lambda[i]);
      visit_pair(slack[i], other.slack[i]);
      visit_pair(y[i], other.y[i]);
      visit_pair(mu[i], other.mu[i]);
    }
    visit_pair(z, other.z);
    visit_pair(zeta, other.zeta);
  }
};

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

class RowModel {
 public:
  RowModel(std::span<const double> matrix, std::size_t stride, std::span<const double> right,
           const MmaRows& rows)
      : m_(right.size()),
        matrix_(matrix),
        stride_(static_cast<int>(stride)),
        right_(right),
        rows_(rows),
        point_(m_),
        predictor_(m_),
        direction_(m_),
        row_(m_),
        elastic_(m_),
        scale_(m_) {
    has_z_ = std::any_of(rows.a.begin(), rows.a.end(), [](double a) { return a != 0.0; });
  }

  MmaMultipliers solve();

 private:
  void start();
  void set_residuals();
  double largest_residual() const;
  struct Products {
    double mean = 0.0, least = std::numeric_limits<double>::infinity();
  };
  Products products(const Point& direction, double t) const;
  bool good(const Point& direction, double t, double mean) const;
  double choose_direction(double mean);
  bool factorize();
  void backsolve(std::vector<double>& vector) const;
  void set_direction(double target, const Point* second_order, Point& direction) const;
  double largest_step(const Point& direction);

  std::size_t m_;
  std::span<const double> matrix_;
  int stride_;
  std::span<const double> right_;
  const MmaRows& rows_;
  bool has_z_;
  Point point_, predictor_, direction_;
  std::vector<double> row_, elastic_;  // residuals of the rows and of mu's equation
  double size_ = 0.0;                  // of b
  double pull_ = 0.0;                  // residual of zeta's equation
  std::vector<double> scale_, factor_, solved_a_;
};

void RowModel::start() {
  for (std::size_t i = 0; i < m_; ++i) {
    const double diagonal = matrix_[i * static_cast<std::size_t>(stride_) + i];
    const double size = std::max(std::abs(right_[i]), least_size);
    const double most = rows_.c[i] + rows_.d[i] * size;
    point_.lambda[i] = std::clamp(size / std::max(diagonal, 1e-100), 1e-6 * most, most);
    point_.slack[i] = size;
    // Without c, y is lambda / d and no more: two numbers that both vanish would only slow things down.
    point_.y[i] = rows_.c[i] > 0.0 ? size : point_.lambda[i] / rows_.d[i];
    point_.mu[i] = rows_.c[i] > 0.0 ? most : 0.0;
  }
  if (has_z_) {
    point_.zeta = rows_.a0;
    point_.z = least_size;
    for (std::size_t i = 0; i < m_; ++i) point_.z = std::max(point_.z, std::abs(right_[i]));
  }
}

void RowModel::set_residuals() {
  const auto m = static_cast<int>(m_);
  const int one = 1;
  const double minus = -1.0, plus = 1.0;
  std::copy(right_.begin(), right_.end(), row_.begin());
  if (m > 0) {
    dsymv_("L", &m, &minus, matrix_.data(), &stride_, point_.lambda.data(), &one, &plus, row_.data(), &one);
  }
  for (std::size_t i = 0; i < m_; ++i) {
    row_[i] += point_.slack[i] - rows_.a[i] * point_.z - point_.y[i];
    elastic_[i] = rows_.c[i] + rows_.d[i] * point_.y[i] - point_.mu[i] - point_.lambda[i];
  }
  pull_ = has_z_ ? rows_.a0 - point_.zeta - dot(rows_.a, point_.lambda) : 0.0;
}

double RowModel::largest_residual() const {
  double largest = std::abs(pull_);
  for (std::size_t i = 0; i < m_; ++i) {
    largest = std::max({largest, std::abs(row_[i]), std::abs(elastic_[i]) / (1.0 + rows_.c[i])});
  }
  return largest;
}

RowModel::Products RowModel::products(const Point& direction, double t) const {
  Products result;
  double sum = 0.0;
  int count = 0;
  const auto add = [&](double first, double second) {
    sum += first * second;
    result.least = std::min(result.least, first * second);
    ++count;
  };
  for (std::size_t i = 0; i < m_; ++i) {
    add(point_.lambda[i] + t * direction.lambda[i], point_.slack[i] + t * direction.slack[i]);
    if (rows_.c[i] <= 0.0) continue;
    add(point_.y[i] + t * direction.y[i], point_.mu[i] + t * direction.mu[i]);
  }
  if (has_z_) add(point_.z + t * direction.z, point_.zeta + t * direction.zeta);
  result.mean = sum / count;
  return result;
}

// Cholesky factors of H + s / lambda + 1 / (d + mu / y) with unit diagonal; should rounding have made it
// indefinite, with the diagonal raised.
bool RowModel::factorize() {
  const auto m = static_cast<int>(m_);
  for (double raise = 0.0; raise < 1.0; raise = std::max(1e-14, 100.0 * raise)) {
    factor_.assign(m_ * m_, 0.0);
    for (std::size_t i = 0; i < m_; ++i) {
      const double own = point_.slack[i] / point_.lambda[i] + 1.0 / (rows_.d[i] + point_.mu[i] / point_.y[i]);
      scale_[i] = 1.0 / std::sqrt(matrix_[i * static_cast<std::size_t>(stride_) + i] + own);
      factor_[i * m_ + i] = own;
    }
    for (std::size_t i = 0; i < m_; ++i) {
      for (std::size_t k = i; k < m_; ++k) {
        factor_[i * m_ + k] += matrix_[i * static_cast<std::size_t>(stride_) + k];
        factor_[i * m_ + k] *= scale_[i] * scale_[k];
      }
      factor_[i * m_ + i] += raise;
    }
    int info = 0;
    dpotrf_("L", &m, factor_.data(), &m, &info);
    if (info != 0) continue;
    if (has_z_) {
      solved_a_ = rows_.a;
      backsolve(solved_a_);
    }
    return true;
  }
  return false;
}

void RowModel::backsolve(std::vector<double>& vector) const {
  const auto m = static_cast<int>(m_);
  const int one = 1;
  int info = 0;
  for (std::size_t i = 0; i < m_; ++i) vector[i] *= scale_[i];
  dpotrs_("L", &m, &one, factor_.data(), &m, vector.data(), &m, &info);
  for (std::size_t i = 0; i < m_; ++i) vector[i] *= scale_[i];
}

// Newton's direction to where all products are `target`, with the products of the predictor's changes taken
// away.
void RowModel::set_direction(double target, const Point* second_order, Point& direction) const {
  const auto wanted = [target](double first, double second, double first_change, double second_change) {
    return target - first * second - first_change * second_change;
  };
  const Point zero(m_);
  const Point& before = second_order == nullptr ? zero : *second_order;
  std::vector<double> slack_wanted(m_), mu_wanted(m_);
  for (std::size_t i = 0; i < m_; ++i) {
    slack_wanted[i] = wanted(point_.lambda[i], point_.slack[i], before.lambda[i], before.slack[i]);
    mu_wanted[i] = rows_.c[i] > 0.0 ? wanted(point_.y[i], point_.mu[i], before.y[i], before.mu[i]) : 0.0;
    const double shift = mu_wanted[i] / point_.y[i] - elastic_[i];
    direction.lambda[i] =
        row_[i] + slack_wanted[i] / point_.lambda[i] - shift / (rows_.d[i] + point_.mu[i] / point_.y[i]);
  }
  backsolve(direction.lambda);
  if (has_z_) {
    const double z_wanted = wanted(point_.z, point_.zeta, before.z, before.zeta);
    direction.z = (dot(rows_.a, direction.lambda) - pull_ + z_wanted / point_.z) /
                  (dot(rows_.a, solved_a_) + point_.zeta / point_.z);
    for (std::size_t i = 0; i < m_; ++i) direction.lambda[i] -= solved_a_[i] * direction.z;
    direction.zeta = (z_wanted - point_.zeta * direction.z) / point_.z;
  }
  for (std::size_t i = 0; i < m_; ++i) {
    const double shift = mu_wanted[i] / point_.y[i] - elastic_[i];
    direction.y[i] = (direction.lambda[i] + shift) / (rows_.d[i] + point_.mu[i] / point_.y[i]);
    direction.mu[i] = (mu_wanted[i] - point_.mu[i] * direction.y[i]) / point_.y[i];
    direction.slack[i] = (slack_wanted[i] - point_.slack[i] * direction.lambda[i]) / point_.lambda[i];
  }
}

double RowModel::largest_step(const Point& direction) {
  double rate = 0.0;
  point_.visit(direction, [&rate](double value, double change) {
    if (change < 0.0) rate = std::max(rate, -change / value);
  });
  return rate > 1.0 ? 1.0 / rate : 1.0;
}

// Whether a step keeps all products near their mean and makes the mean smaller; far from the solution, where the products may
// have to grow, whether it is long.
bool RowModel::good(const Point& direction, double t, double mean) const {
  const auto [next, least] = products(direction, t);
  const bool far = largest_residual() > far_residual * size_ && t > long_step;
  return least >= neighborhood * next && (far || next <= (1.0 - 0.01 * t) * mean);
}

// Mehrotra's direction if it is good, else one that aims nearer to the middle. Returns the step.
double RowModel::choose_direction(double mean) {
  set_direction(0.0, nullptr, predictor_);
  const double reached = products(predictor_, largest_step(predictor_)).mean / mean;
  set_direction(std::pow(std::max(reached, 0.0), 3) * mean, &predictor_, direction_);
  double t = std::min(1.0, to_the_boundary * largest_step(direction_));
  if (good(direction_, t, mean)) return t;
  for (const double part : {0.1, 0.5}) {
    set_direction(part * mean, nullptr, direction_);
    const double longest = std::min(1.0, to_the_boundary * largest_step(direction_));
    for (t = longest; t > 0.3 * longest; t *= 0.7) {
      if (good(direction_, t, mean)) return t;
    }
    t = longest;
  }
  return t;
}

MmaMultipliers RowModel::solve() {
  size_ = least_size;
  for (const double value : right_) size_ = std::max(size_, std::abs(value));
  start();
  const Point zero(m_);
  for (int step = 0; step < step_limit; ++step) {
    set_residuals();
    double terms = size_;  // what rounding is a part of
    for (std::size_t i = 0; i < m_; ++i) {
      terms = std::max(terms, matrix_[i * static_cast<std::size_t>(stride_) + i] * point_.lambda[i]);
    }
    const double mean = products(zero, 0.0).mean;
    const double enough = std::max(residual_tolerance * size_, rounding * terms);
    if ((largest_residual() <= enough && mean <= product_tolerance * size_) || !factorize()) break;
    const double t = choose_direction(mean);
    point_.visit(direction_, [t](double& value, double change) { value += t * change; });
  }
  return {point_.lambda, point_.y, point_.z};
}

}  // namespace

MmaMultipliers solve_row_model(std::span<const double> matrix, std::size_t stride,
                               std::span<const double> right, const MmaRows& rows,
                               std::span<const double> least) {
  if (right.empty()) return {};
  // In terms of lambda - least the least multipliers are 0.
  const auto m = static_cast<int>(right.size()), lead = static_cast<int>(stride);
  const int one = 1;
  const double minus = -1.0, plus = 1.0;
  MmaRows shifted = rows;
  std::vector<double> rest(right.begin(), right.end());
  dsymv_("L", &m, &minus, matrix.data(), &lead, least.data(), &one, &plus, rest.data(), &one);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    shifted.a0 -= rows.a[i] * least[i];
    if (rows.c[i] > 0.0) {
      shifted.c[i] -= least[i];
    } else {
      rest[i] -= least[i] / rows.d[i];  // y = lambda / d
    }
  }
  MmaMultipliers result = RowModel(matrix, stride, rest, shifted).solve();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    result.lambda[i] += least[i];
    if (rows.c[i] <= 0.0) result.y[i] += least[i] / rows.d[i];
  }
  return result;
}

}  // namespace fabseq
