#include "fabseq/optimize/mma_variables.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>

extern "C" void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
                       const double* a, const int* lda, const double* beta, double* c, const int* ldc);

namespace fabseq {

namespace {

constexpr double bulge_factor = 0.501;    // half of 1.001 + 0.001 (Svanberg 2007)
constexpr double step_tolerance = 1e-14;  // of a variable's own equation, in v
constexpr int step_iterations = 60;

}  // namespace

MmaBox::MmaBox(std::size_t local)
    : width(local),
      upper_distance(local, 2.0),
      lower_distance(local, 2.0),
      alpha(local, -1.0),
      beta(local, 1.0),
      curvature(local, 1.0) {}

// A block of variables and, at their minimizers, what the rows need of them.
struct MmaVariables::Block {
  std::size_t count = 0;
  BlockArray upper, lower, alpha, beta, curvature, v;
  BlockArray ratio;           // S / (2 T), from -1 to 1: it alone decides v
  BlockArray width, inverse;  // width and 1 / T
  BlockArray even, bulge;     // e and 0.501 h
  BlockArray even_slope, bulge_slope,
      curvature_slope;  // derivatives of e, 0.501 h, curvature h, over sqrt(D)
  BlockArray kappa;     // -d2psi/(dv dbarrier), over sqrt(D)
  BlockArray wall;      // 0.501 dh/dbarrier
  double curvature_change = 0.0,
         curvature_wall = 0.0;  // sums of curvature h and its derivative, the same for all rows

  void minimize(double barrier);
  double approach(double barrier);
  void expand(double barrier);
};

// One step of all variables to their minimizer: what is left after taking away the barrier of the nearer
// bound is taken as linear, and the quadratic equation for the distance from this bound solved. Returns the
// largest step.
double MmaVariables::Block::approach(double barrier) {
  BlockArray step{};
  for (std::size_t k = 0; k < count; ++k) {
    const double above = upper[k] / (upper[k] - v[k]), below = lower[k] / (lower[k] + v[k]);
    const double up = (1.0 + ratio[k]) * above * above, down = (1.0 - ratio[k]) * below * below;
    const double from_alpha = v[k] - alpha[k], from_beta = beta[k] - v[k];
    const bool at_alpha = from_alpha < from_beta;
    const double near = at_alpha ? from_alpha : from_beta, far = at_alpha ? from_beta : from_alpha;
    const double pull = barrier / far;
    const double value = (at_alpha ? up - down : down - up) + pull;
    const double slope = 2.0 * (up * above / upper[k] + down * below / lower[k]) + pull / far;
    const double linear = value - slope * near;
    const double root = std::sqrt(linear * linear + 4.0 * slope * barrier) + std::abs(linear);
    const double wanted = linear > 0.0 ? 2.0 * barrier / root : root / (2.0 * slope);
    const double distance = std::min(wanted, near + 0.9 * far);
    const double next = at_alpha ? alpha[k] + distance : beta[k] - distance;
    step[k] = std::abs(next - v[k]);
    v[k] = next;
  }
  return *std::max_element(step.begin(), step.end());
}

void MmaVariables::Block::minimize(double barrier) {
  for (int i = 0; i < step_iterations; ++i) {
    if (!(approach(barrier) > step_tolerance)) return;
  }
}

void MmaVariables::Block::expand(double barrier) {
  for (std::size_t k = 0; k < count; ++k) {
    const double above = upper[k] / (upper[k] - v[k]), below = lower[k] / (lower[k] + v[k]);
    const double a = v[k] * above, da = above * above;
    const double b = v[k] * below, db = below * below;
    const double up = 1.0 / (v[k] - alpha[k]), down = 1.0 / (beta[k] - v[k]);
    const double diagonal =
        2.0 * ((1.0 + ratio[k]) * da * above / upper[k] + (1.0 - ratio[k]) * db * below / lower[k]) +
        barrier * (up * up + down * down);
    const double root = std::sqrt(width[k] * inverse[k] / diagonal);
    const double slope = da - db - barrier * (up - down);
    even_slope[k] = 0.5 * (da + db) * root;
    bulge_slope[k] = bulge_factor * slope * root;
    curvature_slope[k] = curvature[k] * slope * root;
    kappa[k] = (up - down) * root / inverse[k];
    even[k] = 0.5 * (a + b) * width[k];
    bulge[k] = bulge_factor * (a - b) * width[k];
  }
  curvature_change = curvature_wall = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double log_wall = -std::log(4.0 * (v[k] - alpha[k]) * (beta[k] - v[k])) * width[k];
    wall[k] = bulge_factor * log_wall;
    bulge[k] += barrier * wall[k];
    curvature_change += curvature[k] * bulge[k] / bulge_factor;
    curvature_wall += curvature[k] * log_wall;
  }
}

MmaVariables::MmaVariables(MPI_Comm comm, const MmaBox& box, std::span<const double> objective_gradient,
                           std::span<const std::span<const double>> gradients)
    : comm_(comm), box_(box), objective_gradient_(objective_gradient), gradients_(gradients) {
  for (auto* vector : {&v_, &plain_, &curved_, &plain_direction_, &curved_direction_})
    vector->assign(box.size(), 0.0);
  const std::size_t rows = gradients.size() + 1;
  scaled_rows_.resize(block_size * rows);
  sums_.schur.resize(rows * rows);
  sums_.change.resize(gradients.size());
  sums_.wall.resize(gradients.size());
}

bool MmaVariables::start(std::span<const double> lambda) {
  combine(lambda, 1.0, plain_, curved_);
  for (std::size_t j = 0; j < box_.size(); ++j) v_[j] = 0.5 * (box_.alpha[j] + box_.beta[j]);
  const bool finite =
      std::all_of(curved_.begin(), curved_.end(), [](double value) { return std::isfinite(value); });
  return !any(comm_, !finite);
}

void MmaVariables::set_direction(std::span<const double> lambda_direction) {
  combine(lambda_direction, 0.0, plain_direction_, curved_direction_);
}

void MmaVariables::advance(double t) {
  for (std::size_t j = 0; j < box_.size(); ++j) {
    plain_[j] += t * plain_direction_[j];
    curved_[j] += t * curved_direction_[j];
  }
}

// S and T for multipliers `lambda` and that of the objective; block by block, so that the sums stay in the
// cache while the rows stream by.
void MmaVariables::combine(std::span<const double> lambda, double objective, std::vector<double>& plain,
                           std::vector<double>& curved) const {
  double weight = objective;
  for (const double value : lambda) weight += value;
  for (std::size_t begin = 0; begin < box_.size(); begin += block_size) {
    const std::size_t count = std::min(block_size, box_.size() - begin);
    BlockArray sum, size;
    for (std::size_t k = 0; k < count; ++k) {
      sum[k] = objective * objective_gradient_[begin + k];
      size[k] = objective * std::abs(objective_gradient_[begin + k]);
    }
    for (std::size_t i = 0; i < lambda.size(); ++i) {
      const double* gradient = gradients_[i].data() + begin;
      const double factor = lambda[i];
      for (std::size_t k = 0; k < count; ++k) {
        sum[k] += factor * gradient[k];
        size[k] += factor * std::abs(gradient[k]);
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      plain[begin + k] = sum[k];
      curved[begin + k] = bulge_factor * size[k] + box_.curvature[begin + k] * weight;
    }
  }
}

const MmaSums& MmaVariables::evaluate(double t, double barrier) {
  const auto rows = static_cast<int>(gradients_.size()) + 1, depth = static_cast<int>(block_size);
  std::fill(sums_.schur.begin(), sums_.schur.end(), 0.0);
  std::fill(sums_.change.begin(), sums_.change.end(), 0.0);
  std::fill(sums_.wall.begin(), sums_.wall.end(), 0.0);
  Block block;
  for (std::size_t begin = 0; begin < box_.size(); begin += block_size) {
    block.count = std::min(block_size, box_.size() - begin);
    load(begin, t, block);
    block.minimize(barrier);
    block.expand(barrier);
    std::copy_n(block.v.begin(), block.count, v_.begin() + static_cast<std::ptrdiff_t>(begin));
    add_rows(begin, block);
    const auto count = static_cast<int>(block.count);
    const double one = 1.0;
    dsyrk_("L", "T", &rows, &count, &one, scaled_rows_.data(), &depth, &one, sums_.schur.data(), &rows);
  }
  reduce();
  return sums_;
}

void MmaVariables::load(std::size_t begin, double t, Block& block) const {
  for (std::size_t k = 0; k < block.count; ++k) {
    const std::size_t j = begin + k;
    const double curved = curved_[j] + t * curved_direction_[j];
    // Rounding must not take away what T >= |S| / 2 grants.
    block.ratio[k] = std::clamp(0.5 * (plain_[j] + t * plain_direction_[j]) / curved, -1.0, 1.0);
    block.inverse[k] = 1.0 / curved;
    block.width[k] = box_.width[j];
    block.upper[k] = box_.upper_distance[j];
    block.lower[k] = box_.lower_distance[j];
    block.alpha[k] = box_.alpha[j];
    block.beta[k] = box_.beta[j];
    block.curvature[k] = box_.curvature[j];
    block.v[k] = v_[j];
  }
}

// The block's columns of G D^(-1/2) and kappa for the rank-k update, and the rows' own change.
void MmaVariables::add_rows(std::size_t begin, const Block& block) {
  constexpr std::size_t lanes = 8;  // independent partial sums, which the compiler turns into vectors
  const std::size_t m = gradients_.size(), count = block.count, whole = count - count % lanes;
  for (std::size_t i = 0; i < m; ++i) {
    const double* __restrict gradient = gradients_[i].data() + begin;
    double* __restrict scaled = scaled_rows_.data() + i * block_size;
    for (std::size_t k = 0; k < count; ++k) {
      scaled[k] = gradient[k] * block.even_slope[k] + std::abs(gradient[k]) * block.bulge_slope[k] +
                  block.curvature_slope[k];
    }
    std::array<double, lanes> partial{}, partial_wall{};
    for (std::size_t k = 0; k < whole; k += lanes) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const double value = gradient[k + lane];
        partial[lane] += value * block.even[k + lane] + std::abs(value) * block.bulge[k + lane];
        partial_wall[lane] += std::abs(value) * block.wall[k + lane];
      }
    }
    for (std::size_t k = whole; k < count; ++k) {
      partial[0] += gradient[k] * block.even[k] + std::abs(gradient[k]) * block.bulge[k];
      partial_wall[0] += std::abs(gradient[k]) * block.wall[k];
    }
    double change = block.curvature_change, wall = block.curvature_wall;
    for (const double value : partial) change += value;
    for (const double value : partial_wall) wall += value;
    sums_.change[i] += change;
    sums_.wall[i] += wall;
  }
  std::copy_n(block.kappa.begin(), count, scaled_rows_.begin() + static_cast<std::ptrdiff_t>(m * block_size));
}

// One message: the lower triangle packed, the rows' own sums.
void MmaVariables::reduce() {
  const std::size_t rows = gradients_.size() + 1;
  message_.clear();
  for (std::size_t column = 0; column < rows; ++column) {
    const double* begin = sums_.schur.data() + column * rows;
    message_.insert(message_.end(), begin + column, begin + rows);
  }
  message_.insert(message_.end(), sums_.change.begin(), sums_.change.end());
  message_.insert(message_.end(), sums_.wall.begin(), sums_.wall.end());
  sum_in_place(comm_, message_);

  const double* next = message_.data();
  for (std::size_t column = 0; column < rows; ++column) {
    for (std::size_t row = column; row < rows; ++row) sums_.schur[column * rows + row] = *next++;
  }
  for (double& value : sums_.change) value = *next++;
  for (double& value : sums_.wall) value = *next++;
}

// Rows are convex in each variable and so largest at one of its ends.
std::vector<double> largest_changes(MPI_Comm comm, const MmaBox& box,
                                    std::span<const std::span<const double>> gradients) {
  constexpr std::size_t block_size = 512;
  std::vector<double> changes(gradients.size());
  std::array<double, block_size> even_up, bulge_up, even_down, bulge_down, curvature, change;
  for (std::size_t begin = 0; begin < box.size(); begin += block_size) {
    const std::size_t count = std::min(block_size, box.size() - begin);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t j = begin + k;
      const auto set = [&](double v, double& even, double& bulge) {
        const double a = v * box.upper_distance[j] / (box.upper_distance[j] - v);
        const double b = v * box.lower_distance[j] / (box.lower_distance[j] + v);
        even = 0.5 * (a + b) * box.width[j];
        bulge = (a - b) * box.width[j];
      };
      set(box.beta[j], even_up[k], bulge_up[k]);
      set(box.alpha[j], even_down[k], bulge_down[k]);
      curvature[k] = box.curvature[j];
    }
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      const double* gradient = gradients[i].data() + begin;
      for (std::size_t k = 0; k < count; ++k) {
        const double size = bulge_factor * std::abs(gradient[k]) + curvature[k];
        change[k] = std::max(gradient[k] * even_up[k] + size * bulge_up[k],
                             gradient[k] * even_down[k] + size * bulge_down[k]);
      }
      for (std::size_t k = 0; k < count; ++k) changes[i] += change[k];
    }
  }
  sum_in_place(comm, changes);
  return changes;
}

}  // namespace fabseq
