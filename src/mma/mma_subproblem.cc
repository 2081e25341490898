// SPDX-License-Identifier: MIT
#include "mma/mma_subproblem.h"

#include "fabseq/base/blas.h"
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

constexpr double first_barrier = 0.1, final_barrier = 1e-10;
constexpr double barrier_factor = 0.03,
                 barrier_power = 1.7;  // of the next barrier, whichever makes it smaller
constexpr double tolerance = 1e-9;     // of the rows' conditions, over the larger of 1 and the largest |f_i|
// How far beyond the maximum along a direction a step may go, in terms of the slope; not at all after so many
// cut steps, so that phi rises in each and they cannot go round in circles.
constexpr double overshoot = 0.5;
constexpr int cut_steps_limit = 12;
constexpr double most_caution = 0.9, least_caution = 0.02;
// Rarely Newton goes in circles nevertheless. From so many cut steps on the least caution grows with each.
constexpr int circling_steps = 20;
constexpr double growing_caution = 0.015;
// Rounding may end above the tolerance: after so many steps without a smaller residual this one is good, too.
constexpr int stall_limit = 20, hopeless_limit = 60;
constexpr double stalled_factor = 1e3;  // times the tolerance
constexpr double value_rounding = 1e-14;
constexpr int newton_step_limit = 300, cut_limit = 12;

// Maximizes the dual function over the rows' multipliers, phi(lambda) = min_v (Lagrangian) - sum (lambda -
// c)_+^2 / (2 d) over lambda >= 0, a^T lambda <= a_0. The minimizing v has one equation a variable
// (MmaVariables). For the rest Newton's method replaces the rows' values by their linear model in lambda, g -
// H (lambda_new - lambda) with H = G D^-1 G^T, and keeps everything that is not smooth as it is: the small
// model problem (solve_row_model) is solved to the end, without another pass over the variables. Only the
// variables' bounds need a barrier that falls from step to step.
//
// H may be flat where a multiplier is too large and steep near 0, and then Newton jumps to 0 from the flat
// side. So a multiplier may only fall to a part (`caution_`) of what it is, the more the last step was cut.
class Solver {
 public:
  Solver(MPI_Comm comm, MmaVariables& variables, std::span<const double> values, const MmaRows& rows)
      : comm_(comm),
        variables_(variables),
        values_(values),
        rows_(rows),
        m_(values.size()),
        lambda_(m_),
        y_(m_),
        direction_(m_),
        function_(m_) {
    for (const double value : values) tolerance_ = std::max(tolerance_, tolerance * std::abs(value));
  }

  MmaReport solve();

 private:
  void start();
  void evaluate(double t);
  void set_direction();
  bool search();
  void lower_barrier();
  double artificial(std::size_t i) const;
  double ascent() const;
  double ascent_rounding() const;
  double residual() const;
  bool stalled(double residual);
  void set_caution(bool good);

  MPI_Comm comm_;
  MmaVariables& variables_;
  std::span<const double> values_;
  const MmaRows& rows_;
  std::size_t m_;
  double tolerance_ = tolerance;
  double barrier_ = first_barrier, caution_ = least_caution;
  int cut_steps_ = 0;
  double least_residual_ = std::numeric_limits<double>::infinity();
  int idle_steps_ = 0;      // since it fell
  bool predicted_ = false;  // function_ belongs to the last barrier and is only extrapolated to this one
  std::vector<double> lambda_, y_, direction_, function_;
  double z_ = 0.0;
  const MmaSums* sums_ = nullptr;
};

void Solver::start() {
  double pull = 0.0;
  for (std::size_t i = 0; i < m_; ++i) {
    const double c = rows_.c[i], d = rows_.d[i], f = values_[i];
    lambda_[i] = f > 0.0 ? std::min(c + d * f, std::max(1.0, d * f)) : 0.0;
    pull += rows_.a[i] * lambda_[i];
  }
  if (pull > rows_.a0) {
    for (double& value : lambda_) value *= rows_.a0 / pull;
  }
  if (!variables_.start(lambda_)) throw NumericalError("MMA: a gradient is not finite");
  evaluate(0.0);
}

void Solver::evaluate(double t) {
  sums_ = &variables_.evaluate(t, barrier_);
  for (std::size_t i = 0; i < m_; ++i) function_[i] = values_[i] + sums_->change[i];
}

// y of row i: what its multiplier says, or without d, where the multiplier says nothing, the model.
double Solver::artificial(std::size_t i) const {
  return rows_.d[i] > 0.0 ? std::max(0.0, lambda_[i] - rows_.c[i]) / rows_.d[i] : y_[i];
}

double Solver::residual() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < m_; ++i) {
    const double value = function_[i] - rows_.a[i] * z_ - artificial(i);
    largest = std::max(largest, value > 0.0 ? value : -value * std::min(1.0, lambda_[i]));
  }
  return largest;
}

// Derivative of phi along the direction.
double Solver::ascent() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < m_; ++i)
    sum += direction_[i] * (function_[i] - (rows_.d[i] > 0.0 ? artificial(i) : 0.0));
  return sum;
}

double Solver::ascent_rounding() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < m_; ++i) sum += std::abs(direction_[i] * function_[i]);
  return value_rounding * sum;
}

void Solver::set_direction() {
  const auto m = static_cast<int>(m_), stride = m + 1;
  const int one = 1;
  const double plus = 1.0;
  std::vector<double> right = function_, least(m_);
  dsymv_("L", &m, &plus, sums_->schur.data(), &stride, lambda_.data(), &one, &plus, right.data(), &one);
  for (std::size_t i = 0; i < m_; ++i)
    least[i] = caution_ * (rows_.c[i] > 0.0 ? std::min(lambda_[i], rows_.c[i]) : lambda_[i]);
  const MmaMultipliers model = solve_row_model(sums_->schur, m_ + 1, right, rows_, least);

  // Ranks must not drift apart, on whatever processors they run: all follow rank 0.
  std::vector<double> message = model.lambda;
  message.insert(message.end(), model.y.begin(), model.y.end());
  message.push_back(model.z);
  broadcast(comm_, message);
  for (const double value : message) {
    if (!std::isfinite(value)) throw NumericalError("MMA: the equations of the rows have no finite solution");
  }
  for (std::size_t i = 0; i < m_; ++i) {
    direction_[i] = message[i] - lambda_[i];
    y_[i] = message[m_ + i];
  }
  z_ = message[2 * m_];
  variables_.set_direction(direction_);
}

// Goes along the direction, where phi is concave, until it no longer rises or does not fall too steeply;
// steps that go too far are cut to where the slope would vanish if it were linear. Returns whether the first
// step was good.
bool Solver::search() {
  const std::vector<double> start = lambda_;
  const double before = std::abs(ascent());
  const double allowed = cut_steps_ < cut_steps_limit ? overshoot : 0.0;
  double t = 1.0;
  for (int cut = 0;; ++cut) {
    for (std::size_t i = 0; i < m_; ++i) lambda_[i] = start[i] + t * direction_[i];
    evaluate(t);
    const double after = ascent();
    const bool good = after >= -allowed * before - ascent_rounding() || residual() <= tolerance_;
    if (good || cut == cut_limit) {
      variables_.advance(t);
      return good && cut == 0;
    }
    if (predicted_) {  // perhaps the start was not what it seemed
      lambda_ = start;
      evaluate(0.0);
      return false;
    }
    t *= std::clamp(before / (before - after), 0.1, 0.7);
  }
}

// The rows' values follow to first order, which saves a pass over the variables.
void Solver::lower_barrier() {
  const double next =
      std::max(final_barrier, std::min(barrier_factor * barrier_, std::pow(barrier_, barrier_power)));
  for (std::size_t i = 0; i < m_; ++i)
    function_[i] += (next - barrier_) * (sums_->wall[i] + sums_->schur[i * (m_ + 1) + m_]);
  predicted_ = next != barrier_;
  barrier_ = next;
}

// Takes note of a step's residual; whether it has not fallen for long.
bool Solver::stalled(double residual) {
  ++idle_steps_;
  if (residual < 0.9 * least_residual_) {
    least_residual_ = residual;
    idle_steps_ = 0;
  }
  return idle_steps_ >= stall_limit;
}

void Solver::set_caution(bool good) {
  if (!good) ++cut_steps_;
  const double next = good ? caution_ * caution_ : std::sqrt(caution_);
  const double least = std::max(least_caution, growing_caution * (cut_steps_ - circling_steps));
  caution_ = std::clamp(next, std::min(least, most_caution), most_caution);
}

MmaReport Solver::solve() {
  MmaReport report;
  if (m_ == 0) barrier_ = final_barrier;
  start();
  while (m_ > 0) {
    set_direction();
    const bool good = search();
    predicted_ = false;
    ++report.newton_steps;
    report.kkt_residual = residual();
    const double enough = (stalled(report.kkt_residual) ? stalled_factor : 1.0) * tolerance_;
    if (barrier_ == final_barrier && report.kkt_residual <= enough) break;
    if (report.newton_steps == newton_step_limit || idle_steps_ == hopeless_limit) {
      report.converged = false;
      break;
    }
    set_caution(good);
    if (good) lower_barrier();
  }
  report.multipliers = lambda_;
  for (std::size_t i = 0; i < m_; ++i)
    if (rows_.c[i] > 0.0) report.largest_violation = std::max(report.largest_violation, artificial(i));
  return report;
}

}  // namespace

MmaReport solve_mma_subproblem(MPI_Comm comm, MmaVariables& variables, std::span<const double> values,
                               const MmaRows& rows) {
  return Solver(comm, variables, values, rows).solve();
}

}  // namespace fabseq
