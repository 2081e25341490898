// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/mpi.h"
#include "multigrid/band_cholesky.h"
#include "multigrid/band_factor.h"
#include "multigrid/lane_hierarchy.h"
#include "multigrid/lane_operator.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// Solves on the last level of a multigrid, by band Cholesky. Lanes with operators of their own are dealt out
/// to the ranks; a single operator for all lanes is the first rank's. Calls are collective on the grid's
/// communicator. `Real`: of right-hand sides, solutions and the factors kept; matrices are factored, and sums
/// computed, in double precision.
template <class Problem, int Width, class Real>
class LaneDirect {
 public:
  static constexpr int dim = Problem::dim;
  static constexpr int components = Problem::components;
  using Operator = LaneOperator<Problem, Width, Real>;

  /// `hierarchy` must outlive the solver.
  explicit LaneDirect(LaneHierarchy<dim>& hierarchy)
      : hierarchy_(hierarchy), numbering_(hierarchy.level(hierarchy.count() - 1).mesh, components) {}

  /// `matrix`: of the last level. `shift`: added to the diagonal, relative to it. False in lanes that are not
  /// positive definite.
  std::array<bool, Width> factor(Operator& matrix, double shift);
  /// Takes over lanes of a wider one, from the ranks that have factored them.
  template <int Wider>
  void select(const LaneDirect<Problem, Wider, Real>& from, std::span<const int> lanes);
  /// Vectors are [node][component][lane] on the last level's mesh or, if its lanes are dealt out, on the
  /// stage of the level above, where `right` is this rank's part.
  void solve(Operator& matrix, const Real* right, Real* solution);

 private:
  template <class, int, class>
  friend class LaneDirect;
  static constexpr int factors = Problem::template operators<Width>;

  void assemble(Operator& matrix, int lane, BandCholesky& band);
  LaneDeal::Layout layout() const;
  std::size_t padded_rows() const {
    return BandFactor<Real>::padded(static_cast<int>(numbering_.rows.size()), numbering_.bandwidth);
  }
  void solve_lanes();

  LaneHierarchy<dim>& hierarchy_;
  BandNumbering<dim> numbering_;
  std::array<std::shared_ptr<const BandFactor<Real>>, factors> factors_;  ///< of the lanes dealt to this rank
  std::array<int, Width> owners_{};                                       ///< rank that solves each lane
  LaneArray values_;
};

template <class Problem, int Width, class Real>
std::array<bool, Width> LaneDirect<Problem, Width, Real>::factor(Operator& matrix, double shift) {
  const MPI_Comm comm = hierarchy_.level(0).comm;
  const auto& rows = numbering_.rows;
  std::array<double, factors> failed{};
  BandCholesky band;
  for (int lane = 0; lane < Width; ++lane) owners_[lane] = Problem::own_operators ? lane % size_of(comm) : 0;
  for (int lane = 0; lane < factors; ++lane) {
    factors_[lane] = nullptr;
    if (owners_[lane] != rank_of(comm)) continue;
    band.resize(static_cast<int>(rows.size()), numbering_.bandwidth);
    assemble(matrix, lane, band);
    if (shift > 0.0) band.raise_diagonal(shift);
    if (band.factor())
      factors_[lane] = std::make_shared<BandFactor<Real>>(band);
    else
      failed[lane] = 1.0;
  }
  sum_in_place(comm, failed);
  std::array<bool, Width> positive;
  positive.fill(true);
  for (int lane = 0; lane < factors; ++lane) positive[lane] = failed[lane] == 0.0;
  return positive;
}

/// Adds up the last level's matrix of a lane.
template <class Problem, int Width, class Real>
void LaneDirect<Problem, Width, Real>::assemble(Operator& matrix, int lane, BandCholesky& band) {
  const LaneLevel<dim>& level = matrix.level();
  constexpr int stride = Operator::Kernel::stride;
  constexpr int size = Problem::element_size;
  const auto& rows = numbering_.rows;
  std::vector<char> held(rows.size(), 0);
  for (const std::int64_t unknown : level.fixed) held[unknown] = 1;
  for (const auto& row : level.mesh.rows())
    for (int e = 0; e < row.length; ++e) {
      const Real* coefficients = &matrix.coefficients()[(row.element + e) * stride];
      std::array<std::int64_t, size> unknowns;
      for (int i = 0; i < size; ++i) {
        const int corner = i / components;
        unknowns[i] = (row.node[corner / 2] + e + corner % 2) * components + i % components;
      }
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
          if (held[unknowns[i]] == 0 && held[unknowns[j]] == 0)
            band.add(rows[unknowns[i]], rows[unknowns[j]],
                     Problem::template entry<Width>(matrix.matrices(), i, j, coefficients, lane));
    }
}

template <class Problem, int Width, class Real>
template <int Wider>
void LaneDirect<Problem, Width, Real>::select(const LaneDirect<Problem, Wider, Real>& from,
                                              std::span<const int> lanes) {
  for (int lane = 0; lane < Width; ++lane) owners_[lane] = from.owners_[selected(lanes, lane)];
  for (int lane = 0; lane < factors; ++lane) {
    if constexpr (Problem::own_operators)
      factors_[lane] = from.factors_[selected(lanes, lane)];
    else
      factors_[lane] = from.factors_[lane];  // the one for all lanes
  }
}

/// Lanes with factors of their own are solved one by one, the others side by side.
template <class Problem, int Width, class Real>
LaneDeal::Layout LaneDirect<Problem, Width, Real>::layout() const {
  if (Problem::own_operators) return {numbering_.rows, components, 1, padded_rows()};
  return {numbering_.rows, components, Width, 1};
}

template <class Problem, int Width, class Real>
void LaneDirect<Problem, Width, Real>::solve(Operator& matrix, const Real* right, Real* solution) {
  const LaneLevel<dim>& level = matrix.level();
  const LaneDeal::Layout places = layout();
  const auto place = [&](std::size_t unknown, int lane) {
    return places.rows[unknown] * places.row_stride + lane * places.lane_stride;
  };
  values_.assign(padded_rows() * Width, 0.0);
  if (level.lanes_dealt) {
    hierarchy_.deal().add_at_owners(owners_, places, right, values_.data());
    for (const std::int64_t unknown : level.fixed)
      for (int lane = 0; lane < Width; ++lane) values_[place(unknown, lane)] = 0.0;
    solve_lanes();
    hierarchy_.deal().fetch_from_owners(owners_, places, values_.data(), solution);
    return;
  }
  for (std::size_t unknown = 0; unknown < places.rows.size(); ++unknown)
    for (int lane = 0; lane < Width; ++lane) values_[place(unknown, lane)] = right[unknown * Width + lane];
  solve_lanes();
  for (std::size_t unknown = 0; unknown < places.rows.size(); ++unknown)
    for (int lane = 0; lane < Width; ++lane)
      solution[unknown * Width + lane] = static_cast<Real>(values_[place(unknown, lane)]);
  matrix.clear_held(solution);
}

/// Solves the lanes that this rank has factored, in place on values_.
template <class Problem, int Width, class Real>
void LaneDirect<Problem, Width, Real>::solve_lanes() {
  if constexpr (Problem::own_operators) {
    for (int lane = 0; lane < Width; ++lane)
      if (factors_[lane] != nullptr) factors_[lane]->template solve<1>(values_.data() + lane * padded_rows());
  } else if (factors_[0] != nullptr) {
    factors_[0]->template solve<Width>(values_.data());
  }
}

}  // namespace fabseq
