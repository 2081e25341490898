// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_array.h"
#include "kernels/lane_problem.h"
#include "kernels/lane_sweep.h"
#include "multigrid/lane_hierarchy.h"
#include "multigrid/node_scaling.h"

#include <algorithm>

namespace fabseq {

/// K x for every lane on one level, without a matrix, its residual and its smoother. Vectors are
/// [node][component][lane] on the level's mesh, the same on all holders of a node, and zero at held unknowns.
/// All calls that take vectors are collective on the level's communicator unless they say otherwise. `Real`:
/// double, or float in preconditioners; inner products are double.
template <class Problem, int Width, class Real = double>
class LaneOperator {
 public:
  static constexpr int dim = Problem::dim;
  static constexpr int components = Problem::components;
  static constexpr int node_values = components * Width;
  using Kernel = typename Problem::template Kernel<Width, Real>;
  using Scaling = NodeScaling<Problem, Width, Real>;
  using Scalars = LaneScalars<Width>;

  /// `level` must outlive the operator.
  LaneOperator(LaneLevel<dim>& level, const Problem& problem)
      : level_(level),
        matrices_(problem.matrices(level.spacing)),
        coefficients_(static_cast<std::size_t>(level.mesh.elements()) * Kernel::stride),
        window_(static_cast<std::size_t>(level.mesh.window()) * node_values),
        shared_(level.shared.nodes().size() * node_values) {}

  LaneLevel<dim>& level() { return level_; }
  const typename Problem::Matrices& matrices() const { return matrices_; }
  /// Values of a vector on this rank.
  std::size_t size() const { return static_cast<std::size_t>(level_.mesh.nodes()) * node_values; }
  /// The coefficients as the kernel takes them; to be filled in before set_up().
  LaneValues<Real>& coefficients() { return coefficients_; }
  /// What smooth() needs.
  void set_up() { scaling_.set_up(level_, matrices_, coefficients_.data()); }
  /// Takes over lanes of a wider operator on the same level.
  template <int Wider>
  void select(const LaneOperator<Problem, Wider, Real>& from, std::span<const int> lanes);

  /// y = K x; returns this rank's part of x . y in each lane.
  Scalars apply(const Real* x, Real* y);
  /// This rank's part of the residual b - K x: parts of shared nodes add up to it. Not collective.
  void residual_part(const Real* b, const Real* x, Real* residual);
  /// Chebyshev iteration of `degree` on the scaled operator, for eigenvalues from `low_end` of the largest
  /// one up, from x or, `from_zero`, from nothing. `step` is scratch.
  void smooth(const Real* b, Real* x, Real* step, int degree, bool from_zero);
  /// Sets held unknowns to 0. Not collective.
  void clear_held(Real* values) const;
  /// This rank's parts of x . y for one or several y, doubles or floats. Not collective.
  template <class X, class... Y>
  std::array<Scalars, sizeof...(Y)> dots(const X* x, const Y*... y) const;
  template <class X, class Y>
  Scalars dot(const X* x, const Y* y) const {
    return dots(x, y)[0];
  }

 private:
  template <class, int, class>
  friend class LaneOperator;
  /// Share of the largest eigenvalue above which the smoother damps.
  static constexpr double low_end = 0.15;
  /// Vectors larger than this are written past the caches: nothing of them would be left there.
  static constexpr std::size_t cache_bytes = std::size_t{1} << 22;
  using Value = Lanes<Width, Real>;

  /// Loads a node or, with one component, several that follow each other: as many lanes as `Loaded` has.
  template <class Loaded = Value>
  [[gnu::always_inline]] static std::array<Loaded, components> load(const Real* from) {
    std::array<Loaded, components> values;
    for (int a = 0; a < components; ++a) values[a] = Loaded::load(from + a * Width);
    return values;
  }
  template <class Stored>
  [[gnu::always_inline]] static void put(const Stored& value, Real* place, bool past_caches) {
    // Several nodes need not begin where a register does.
    if (past_caches && Stored::width == Width)
      value.stream(place);
    else
      value.store(place);
  }
  /// Calls `finish(node, sums, counted)` for every node, shared ones with the sum over their holders, whether
  /// or not this rank counts them in inner products. Several nodes may come at once (sweep()).
  template <class Finish>
  void complete_sweep(const Real* x, Finish&& finish);
  void first_step_from_zero(const Real* b, Real* x, Real scale) const;
  /// x += step, step = momentum * old + scale * D^-1 (b - K x). `kept`, if any, gets the step. One function
  /// for every step of the iteration: each copy of the sweep takes seconds to compile.
  void smoother_step(const Real* b, Real* x, const Real* old, Real* kept, Real momentum, Real scale);

  LaneLevel<dim>& level_;
  typename Problem::Matrices matrices_;
  LaneValues<Real> coefficients_, window_, shared_;
  Scaling scaling_;
};

template <class Problem, int Width, class Real>
template <int Wider>
void LaneOperator<Problem, Width, Real>::select(const LaneOperator<Problem, Wider, Real>& from,
                                                std::span<const int> lanes) {
  if constexpr (Problem::own_operators)
    select_lanes(from.coefficients_, Wider, lanes, coefficients_, Width);
  else
    coefficients_ = from.coefficients_;
  scaling_.template select<Wider>(from.scaling_, lanes);
}

template <class Problem, int Width, class Real>
template <class Finish>
void LaneOperator<Problem, Width, Real>::complete_sweep(const Real* x, Finish&& finish) {
  const Kernel kernel = Problem::template kernel<Width>(matrices_, coefficients_.data());
  sweep(level_.mesh, kernel, x, window_.data(), shared_.data(),
        [&](std::int64_t node, const auto& sums) { finish(node, sums, true); });
  if (!level_.distributed) return;
  level_.shared.sum(std::span<Real>(shared_), node_values);
  const auto& nodes = level_.shared.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    finish(nodes[i], load(&shared_[i * node_values]), level_.shared.counted()[i] != 0);
}

template <class Problem, int Width, class Real>
LaneScalars<Width> LaneOperator<Problem, Width, Real>::apply(const Real* x, Real* y) {
  std::array<Lanes<Width>, components> products;
  products.fill(Lanes<Width>::zero());
  const bool past_caches = size() * sizeof(Real) > cache_bytes;
  complete_sweep(x, [&]<class Sum>(std::int64_t node, const std::array<Sum, components>& sums, bool counted) {
    for (int a = 0; a < components; ++a) {
      const std::int64_t at = node * node_values + a * Width;
      const Sum product = Sum::load(x + at) * sums[a];
      put(sums[a], y + at, past_caches);
      if (counted) add_up(product, products[a]);
    }
  });
  clear_held(y);
  Scalars result;
  for (int lane = 0; lane < Width; ++lane) {
    result[lane] = 0.0;
    for (const auto& product : products) result[lane] += product[lane];
  }
  return result;
}

template <class Problem, int Width, class Real>
void LaneOperator<Problem, Width, Real>::residual_part(const Real* b, const Real* x, Real* residual) {
  const Kernel kernel = Problem::template kernel<Width>(matrices_, coefficients_.data());
  const bool past_caches = size() * sizeof(Real) > cache_bytes;
  const auto finish = [&]<class Sum>(std::int64_t node, const std::array<Sum, components>& sums) {
    const auto right = load<Sum>(b + node * node_values);
    for (int a = 0; a < components; ++a)
      put(right[a] - sums[a], residual + node * node_values + a * Width, past_caches);
  };
  sweep(level_.mesh, kernel, x, window_.data(), shared_.data(), finish);
  const auto& nodes = level_.shared.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int entry = 0; entry < node_values; ++entry) {
      const std::size_t at = static_cast<std::size_t>(nodes[i]) * node_values + entry;
      residual[at] = (level_.shared.counted()[i] != 0 ? b[at] : Real{0}) - shared_[i * node_values + entry];
    }
  clear_held(residual);
}

template <class Problem, int Width, class Real>
void LaneOperator<Problem, Width, Real>::first_step_from_zero(const Real* b, Real* x, Real scale) const {
  for (std::int64_t node = 0; node < level_.mesh.nodes(); ++node) {
    const auto scaled = scaling_.apply(node, load(b + node * node_values));
    for (int a = 0; a < components; ++a) (scaled[a] * scale).store(x + node * node_values + a * Width);
  }
}

template <class Problem, int Width, class Real>
void LaneOperator<Problem, Width, Real>::smoother_step(const Real* b, Real* x, const Real* old, Real* kept,
                                                       Real momentum, Real scale) {
  constexpr int cache_line = 64 / sizeof(Real);
  complete_sweep(x, [&]<class Sum>(std::int64_t node, const std::array<Sum, components>& sums, bool) {
    constexpr std::int64_t ahead = 24;  // nodes, for the processor to have them when they are due
    scaling_.prefetch(node + ahead);
    for (int entry = 0; entry < node_values; entry += cache_line)
      __builtin_prefetch(b + (node + ahead) * node_values + entry);
    std::array<Sum, components> difference;
    const auto right = load<Sum>(b + node * node_values);
    for (int a = 0; a < components; ++a) difference[a] = right[a] - sums[a];
    const auto scaled = scaling_.apply(node, difference);
    for (int a = 0; a < components; ++a) {
      const std::int64_t at = node * node_values + a * Width;
      const auto value = Sum::load(x + at);
      const auto change = scaled[a] * scale + Sum::load(old + at) * momentum;
      if (kept) change.store(kept + at);
      (value + change).store(x + at);
    }
  });
}

template <class Problem, int Width, class Real>
void LaneOperator<Problem, Width, Real>::smooth(const Real* b, Real* x, Real* step, int degree,
                                                bool from_zero) {
  const double high = matrices_.spectrum_bound;
  const double center = 0.5 * (1.0 + low_end) * high;
  const double radius = 0.5 * (1.0 - low_end) * high;
  const double ratio = center / radius;
  const auto first_scale = static_cast<Real>(1.0 / center);
  double rho = 1.0 / ratio;
  for (int k = 0; k < degree; ++k) {
    Real* const kept = k + 1 < degree ? step : nullptr;
    if (k == 0) {
      if (from_zero)
        first_step_from_zero(b, x, first_scale);
      else
        smoother_step(b, x, x, kept, Real{0}, first_scale);
      continue;
    }
    const double next_rho = 1.0 / (2.0 * ratio - rho);
    const auto momentum = static_cast<Real>(next_rho * rho);
    const auto scale = static_cast<Real>(2.0 * next_rho / radius);
    rho = next_rho;
    // After a first step from zero, x is this step.
    smoother_step(b, x, from_zero && k == 1 ? x : step, kept, momentum, scale);
  }
}

template <class Problem, int Width, class Real>
void LaneOperator<Problem, Width, Real>::clear_held(Real* values) const {
  for (const std::int64_t unknown : level_.fixed) std::fill_n(values + unknown * Width, Width, Real{0});
}

template <class Problem, int Width, class Real>
template <class X, class... Y>
std::array<LaneScalars<Width>, sizeof...(Y)> LaneOperator<Problem, Width, Real>::dots(const X* x,
                                                                                      const Y*... y) const {
  // A few sums side by side: each addition waits for the one before.
  constexpr int chains = sizeof...(Y) == 1 ? 4 : 2;
  std::array<std::array<Lanes<Width>, sizeof...(Y)>, chains> sums;
  for (auto& chain : sums) chain.fill(Lanes<Width>::zero());
  const auto add = [&](std::int64_t i, auto& chain) {
    const auto value = Lanes<Width>::load(x + i * Width);
    std::size_t next = 0;
    ((chain[next++] += value * Lanes<Width>::load(y + i * Width)), ...);
  };
  for (const auto& range : level_.counted) {
    std::int64_t i = range.begin * components;
    const std::int64_t end = range.end * components;
    for (; i + chains <= end; i += chains)
      for (int chain = 0; chain < chains; ++chain) add(i + chain, sums[chain]);
    for (; i < end; ++i) add(i, sums[0]);
  }
  std::array<Scalars, sizeof...(Y)> result;
  for (std::size_t which = 0; which < result.size(); ++which)
    for (int lane = 0; lane < Width; ++lane) {
      result[which][lane] = 0.0;
      for (const auto& chain : sums) result[which][lane] += chain[which][lane];
    }
  return result;
}

}  // namespace fabseq
