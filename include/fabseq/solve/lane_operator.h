/// \file
/// The operator of one multigrid level for several lanes, its residual and its smoother.
#pragma once

#include "fabseq/fem/lane_sweep.h"
#include "fabseq/solve/lane_hierarchy.h"
#include "fabseq/solve/lane_problem.h"
#include "fabseq/solve/node_scaling.h"

#include <algorithm>

namespace fabseq {

/// K x for every lane, without a matrix. Vectors are [node][component][lane] on the level's mesh, the same on
/// all holders of a node, and zero at held unknowns. All calls that take vectors are collective on the
/// level's communicator unless they say otherwise.
template <class Problem, int Width>
class LaneOperator {
 public:
  static constexpr int dim = Problem::dim;
  static constexpr int components = Problem::components;
  static constexpr int block = components * Width;
  using Kernel = typename Problem::template Kernel<Width>;
  using Scaling = NodeScaling<Problem, Width>;
  using Scalars = LaneScalars<Width>;

  /// `level` must outlive the operator.
  LaneOperator(LaneLevel<dim>& level, const Problem& problem)
      : level_(level),
        matrices_(problem.matrices(level.spacing)),
        coefficients_(static_cast<std::size_t>(level.mesh.elements()) * Kernel::stride),
        window_(static_cast<std::size_t>(level.mesh.window()) * block),
        shared_(level.shared.nodes().size() * block) {}

  LaneLevel<dim>& level() { return level_; }
  const typename Problem::Matrices& matrices() const { return matrices_; }
  /// Values of a vector on this rank.
  std::size_t size() const { return static_cast<std::size_t>(level_.mesh.nodes()) * block; }
  /// As the kernel takes them; to be filled, then set_up().
  LaneArray& coefficients() { return coefficients_; }
  void set_up() { scaling_.set_up(level_, matrices_, coefficients_.data()); }
  /// Takes over lanes of a wider operator on the same level.
  template <int Wider>
  void select(const LaneOperator<Problem, Wider>& from, std::span<const int> lanes);

  /// y = K x; returns this rank's part of x . y in each lane.
  Scalars apply(const double* x, double* y);
  /// This rank's part of the residual b - K x: parts of shared nodes add up to it. Not collective.
  void residual_part(const double* b, const double* x, double* residual);
  /// Chebyshev iteration of `degree` on the scaled operator, for eigenvalues from `low_end` of the largest
  /// one up, from x or, `from_zero`, from nothing. `step` is scratch.
  void smooth(const double* b, double* x, double* step, int degree, bool from_zero);
  /// Sets held unknowns to 0. Not collective.
  void clear_held(double* values) const;
  /// This rank's part of x . y. Not collective.
  Scalars dot(const double* x, const double* y) const;

 private:
  template <class, int>
  friend class LaneOperator;
  /// Share of the largest eigenvalue above which the smoother damps.
  static constexpr double low_end = 0.15;
  using Values = std::array<Lanes<Width>, components>;

  static Values load(const double* from) {
    Values values;
    for (int a = 0; a < components; ++a) values[a] = Lanes<Width>::load(from + a * Width);
    return values;
  }
  /// Calls `finish` for every node, shared ones with the sum over their holders.
  template <class Finish>
  void complete_sweep(const double* x, Finish&& finish);
  void first_step_from_zero(const double* b, double* x, double scale) const;
  /// x += step, step = momentum * old step + scale * D^-1 (b - K x). The old step is none, x itself (after
  /// a first step from zero) or `step`; the new one is stored if a further step needs it.
  template <bool HasOld, bool OldIsX, bool Keep>
  void smoother_step(const double* b, double* x, double* step, double momentum, double scale);

  LaneLevel<dim>& level_;
  typename Problem::Matrices matrices_;
  LaneArray coefficients_, window_, shared_;
  Scaling scaling_;
};

template <class Problem, int Width>
template <int Wider>
void LaneOperator<Problem, Width>::select(const LaneOperator<Problem, Wider>& from,
                                          std::span<const int> lanes) {
  if constexpr (Problem::own_operators)
    select_lanes(from.coefficients_, Wider, lanes, coefficients_, Width);
  else
    coefficients_ = from.coefficients_;
  scaling_.template select<Wider>(from.scaling_, lanes);
}

template <class Problem, int Width>
template <class Finish>
void LaneOperator<Problem, Width>::complete_sweep(const double* x, Finish&& finish) {
  const Kernel kernel = Problem::template kernel<Width>(matrices_, coefficients_.data());
  sweep(level_.mesh, kernel, x, window_.data(), shared_.data(), finish);
  if (!level_.distributed) return;
  level_.shared.sum(shared_, block);
  const auto& nodes = level_.shared.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) finish(nodes[i], load(&shared_[i * block]));
}

template <class Problem, int Width>
LaneScalars<Width> LaneOperator<Problem, Width>::apply(const double* x, double* y) {
  complete_sweep(x, [&](std::int64_t node, const Values& sums) {
    for (int a = 0; a < components; ++a) sums[a].stream(y + node * block + a * Width);
  });
  clear_held(y);
  return dot(x, y);
}

template <class Problem, int Width>
void LaneOperator<Problem, Width>::residual_part(const double* b, const double* x, double* residual) {
  const Kernel kernel = Problem::template kernel<Width>(matrices_, coefficients_.data());
  sweep(level_.mesh, kernel, x, window_.data(), shared_.data(), [&](std::int64_t node, const Values& sums) {
    const Values right = load(b + node * block);
    for (int a = 0; a < components; ++a) (right[a] - sums[a]).store(residual + node * block + a * Width);
  });
  const auto& nodes = level_.shared.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int entry = 0; entry < block; ++entry) {
      const std::size_t at = static_cast<std::size_t>(nodes[i]) * block + entry;
      residual[at] = (level_.shared.counted()[i] != 0 ? b[at] : 0.0) - shared_[i * block + entry];
    }
  clear_held(residual);
}

template <class Problem, int Width>
void LaneOperator<Problem, Width>::first_step_from_zero(const double* b, double* x, double scale) const {
  for (std::int64_t node = 0; node < level_.mesh.nodes(); ++node) {
    const Values scaled = scaling_.apply(node, load(b + node * block));
    for (int a = 0; a < components; ++a) (scaled[a] * scale).store(x + node * block + a * Width);
  }
}

template <class Problem, int Width>
template <bool HasOld, bool OldIsX, bool Keep>
void LaneOperator<Problem, Width>::smoother_step(const double* b, double* x, double* step, double momentum,
                                                 double scale) {
  complete_sweep(x, [&](std::int64_t node, const Values& sums) {
    constexpr std::int64_t ahead = 24;  // nodes, for the processor to have them when they are due
    scaling_.prefetch(node + ahead);
    for (int entry = 0; entry < block; entry += 8) __builtin_prefetch(b + (node + ahead) * block + entry);
    Values difference;
    const Values right = load(b + node * block);
    for (int a = 0; a < components; ++a) difference[a] = right[a] - sums[a];
    const Values scaled = scaling_.apply(node, difference);
    for (int a = 0; a < components; ++a) {
      double* const place = x + node * block + a * Width;
      double* const step_place = step + node * block + a * Width;
      const auto value = Lanes<Width>::load(place);
      auto change = scaled[a] * scale;
      if constexpr (HasOld) change += (OldIsX ? value : Lanes<Width>::load(step_place)) * momentum;
      if constexpr (Keep) change.store(step_place);
      (value + change).store(place);
    }
  });
}

template <class Problem, int Width>
void LaneOperator<Problem, Width>::smooth(const double* b, double* x, double* step, int degree,
                                          bool from_zero) {
  const double high = matrices_.spectrum_bound;
  const double center = 0.5 * (1.0 + low_end) * high;
  const double radius = 0.5 * (1.0 - low_end) * high;
  const double ratio = center / radius;
  double rho = 1.0 / ratio;
  for (int k = 0; k < degree; ++k) {
    const bool keep = k + 1 < degree;
    if (k == 0) {
      if (from_zero)
        first_step_from_zero(b, x, 1.0 / center);
      else if (keep)
        smoother_step<false, false, true>(b, x, step, 0.0, 1.0 / center);
      else
        smoother_step<false, false, false>(b, x, step, 0.0, 1.0 / center);
      continue;
    }
    const double next_rho = 1.0 / (2.0 * ratio - rho);
    const double momentum = next_rho * rho;
    const double scale = 2.0 * next_rho / radius;
    rho = next_rho;
    const bool old_is_x = from_zero && k == 1;
    if (old_is_x && keep)
      smoother_step<true, true, true>(b, x, step, momentum, scale);
    else if (old_is_x)
      smoother_step<true, true, false>(b, x, step, momentum, scale);
    else if (keep)
      smoother_step<true, false, true>(b, x, step, momentum, scale);
    else
      smoother_step<true, false, false>(b, x, step, momentum, scale);
  }
}

template <class Problem, int Width>
void LaneOperator<Problem, Width>::clear_held(double* values) const {
  for (const std::int64_t unknown : level_.fixed) std::fill_n(values + unknown * Width, Width, 0.0);
}

template <class Problem, int Width>
LaneScalars<Width> LaneOperator<Problem, Width>::dot(const double* x, const double* y) const {
  // A few sums side by side: each addition waits for the one before.
  constexpr int chains = 4;
  std::array<Lanes<Width>, chains> sums;
  sums.fill(Lanes<Width>::zero());
  for (const auto& range : level_.counted) {
    const std::int64_t begin = range.begin * components;
    const std::int64_t end = range.end * components;
    std::int64_t i = begin;
    for (; i + chains <= end; i += chains)
      for (int chain = 0; chain < chains; ++chain)
        sums[chain] +=
            Lanes<Width>::load(x + (i + chain) * Width) * Lanes<Width>::load(y + (i + chain) * Width);
    for (; i < end; ++i) sums[0] += Lanes<Width>::load(x + i * Width) * Lanes<Width>::load(y + i * Width);
  }
  Scalars result;
  for (int lane = 0; lane < Width; ++lane)
    result[lane] = (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]);
  return result;
}

}  // namespace fabseq
