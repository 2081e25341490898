// SPDX-License-Identifier: MIT
/// \file
/// Definitions of LaneMultigrid, for the files that instantiate it.
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/lanes/lane_multigrid.h"

#include <algorithm>

namespace fabseq {

template <class Problem, int Width, class Real>
LaneMultigrid<Problem, Width, Real>::LaneMultigrid(LaneHierarchy<dim>& hierarchy, const Problem& problem,
                                                   const LaneCycle& cycle)
    : hierarchy_(hierarchy), cycle_(cycle) {
  for (int index = 0; index < hierarchy.count(); ++index) {
    Level& level = levels_.emplace_back();
    level.matrix = std::make_unique<Operator>(hierarchy.level(index), problem);
    const std::size_t size = level.matrix->size();
    const bool last = index + 1 == hierarchy.count();
    const bool iterated =
        !last && index > 0 && std::max(cycle_.steps_on(index, false), cycle_.steps_on(index, true)) > 1;
    if (!last) {
      level.residual.resize(size);
      level.step.resize(size);
    }
    if (index > 0) {
      level.right.resize(size);
      level.solution.resize(size);
    }
    for (Array* array : {&level.cg_residual, &level.direction, &level.image, &level.scratch, &level.product})
      if (iterated) array->resize(size);
  }
  const auto& last = hierarchy.level(hierarchy.count() - 1);
  numbering_ = BandNumbering<dim>(last.mesh, components);
}

template <class Problem, int Width, class Real>
std::array<bool, Width> LaneMultigrid<Problem, Width, Real>::set_up() {
  for (int level = 0; level + 1 < hierarchy_.count(); ++level) {
    levels_[level].matrix->set_up();
    coarsen_coefficients(level);
  }
  return factor();
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::coarsen_coefficients(int level) {
  constexpr int stride = Operator::Kernel::stride;
  const LaneLevel<dim>& fine = hierarchy_.level(level);
  const Array& from = levels_[level].matrix->coefficients();
  Array& to = levels_[level + 1].matrix->coefficients();
  std::fill(to.begin(), to.end(), Real{0});
  Real share{1};
  for (const int factor : fine.factors) share /= static_cast<Real>(factor);
  for (std::size_t element = 0; element < fine.parent.size(); ++element)
    for (int i = 0; i < stride; ++i)
      to[fine.parent[element] * stride + i] += share * from[element * stride + i];
  if (fine.distributed && !hierarchy_.level(level + 1).distributed)
    sum_in_place(fine.comm, std::span<Real>(to));
}

/// Every rank has the last level, but factors only the lanes dealt to it, if they have operators of their
/// own.
template <class Problem, int Width, class Real>
std::array<bool, Width> LaneMultigrid<Problem, Width, Real>::factor() {
  const MPI_Comm comm = hierarchy_.level(0).comm;
  const auto& rows = numbering_.rows();
  std::array<double, factors> failed{};
  for (int lane = 0; lane < factors; ++lane) {
    factors_[lane] = nullptr;
    if (Problem::own_operators && lane % size_of(comm) != rank_of(comm)) continue;
    factors_[lane] = std::make_shared<BandCholesky>();
    factors_[lane]->resize(static_cast<int>(rows.size()), numbering_.bandwidth());
    assemble(lane, *factors_[lane]);
    if (!factors_[lane]->factor()) failed[lane] = 1.0;
  }
  sum_in_place(comm, failed);
  std::array<bool, Width> positive;
  positive.fill(true);
  for (int lane = 0; lane < factors; ++lane) positive[lane] = failed[lane] == 0.0;
  return positive;
}

/// Adds up the last level's matrix of a lane.
template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::assemble(int lane, BandCholesky& band) {
  Operator& matrix = *levels_.back().matrix;
  const LaneLevel<dim>& level = matrix.level();
  constexpr int stride = Operator::Kernel::stride;
  constexpr int size = Problem::element_size;
  const auto& rows = numbering_.rows();
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
  if (cycle_.shift > 0.0) band.raise_diagonal(cycle_.shift);
}

template <class Problem, int Width, class Real>
template <int Wider>
void LaneMultigrid<Problem, Width, Real>::select(LaneMultigrid<Problem, Wider, Real>& from,
                                                 std::span<const int> lanes) {
  for (std::size_t level = 0; level < levels_.size(); ++level)
    levels_[level].matrix->template select<Wider>(*from.levels_[level].matrix, lanes);
  for (int lane = 0; lane < factors; ++lane) {
    if constexpr (Problem::own_operators)
      factors_[lane] = from.factors_[selected(lanes, lane)];
    else
      factors_[lane] = from.factors_[lane];  // the one for all lanes
  }
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::visit(int index, const Real* b, Real* x) {
  Level& level = levels_[index];
  if (index + 1 == hierarchy_.count()) {
    if (index == 0) {
      levels_[0].right.assign(b, b + level.matrix->size());
      levels_[0].solution.resize(level.matrix->size());
      solve_directly();
      std::copy(levels_[0].solution.begin(), levels_[0].solution.end(), x);
    }
    return;
  }
  level.matrix->smooth(b, x, level.step.data(), cycle_.degree, true);
  level.matrix->residual_part(b, x, level.residual.data());
  restrict_residual(index);
  solve(index + 1);
  hierarchy_.level(index).transfer.template prolong_add<components, Width>(levels_[index + 1].solution.data(),
                                                                           x);
  level.matrix->clear_held(x);
  level.matrix->smooth(b, x, level.step.data(), cycle_.degree, false);
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::restrict_residual(int index) {
  LaneLevel<dim>& fine = hierarchy_.level(index);
  LaneLevel<dim>& coarse = hierarchy_.level(index + 1);
  Level& below = levels_[index + 1];
  std::fill(below.right.begin(), below.right.end(), Real{0});
  fine.transfer.template restrict_add<components, Width>(levels_[index].residual.data(), below.right.data());
  if (coarse.distributed)
    sum_over_holders(coarse, below.right.data(), node_values);
  else if (fine.distributed)
    sum_in_place(fine.comm, std::span<Real>(below.right));
  below.matrix->clear_held(below.right.data());
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::solve(int index) {
  const int steps = cycle_.steps_on(index, patient_);
  if (index + 1 == hierarchy_.count())
    solve_directly();
  else if (steps == 1)
    visit(index, levels_[index].right.data(), levels_[index].solution.data());
  else if (cycle_.kind == SolverCycle::w)
    iterate(index, steps);
  else
    conjugate_gradients(index, steps);
}

/// x += M (b - K x): symmetric, and positive if the largest eigenvalue of M K is below 2.
template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::iterate(int index, int steps) {
  Level& level = levels_[index];
  visit(index, level.right.data(), level.solution.data());
  for (int step = 1; step < steps; ++step) {
    level.matrix->apply(level.solution.data(), level.image.data());
    for (std::size_t i = 0; i < level.cg_residual.size(); ++i)
      level.cg_residual[i] = level.right[i] - level.image[i];
    visit(index, level.cg_residual.data(), level.scratch.data());
    for (std::size_t i = 0; i < level.cg_residual.size(); ++i) level.solution[i] += level.scratch[i];
  }
}

/// Flexible conjugate gradients with one reduction per step: with z = M r and w = K z, the new direction
/// p = z - (z.q / p.q) p_old has the image q = w - (z.q / p.q) q_old and p.q = z.w - (z.q)^2 / p.q_old.
template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::conjugate_gradients(int index, int steps) {
  Level& level = levels_[index];
  Operator& matrix = *level.matrix;
  Scalars energy;  // p . K p
  energy.fill(0.0);
  for (int step = 0; step < steps; ++step) {
    const Array& residual = step == 0 ? level.right : level.cg_residual;
    visit(index, residual.data(), level.scratch.data());
    std::array<double, static_cast<std::size_t>(3) * Width> sums{};
    const Scalars own = matrix.apply(level.scratch.data(), level.product.data());
    const auto put = [&](int which, const Scalars& values) {
      std::copy(values.begin(), values.end(), sums.begin() + static_cast<std::ptrdiff_t>(which) * Width);
    };
    put(0, own);
    if (step == 0) {
      put(1, matrix.dot(level.scratch.data(), residual.data()));
    } else {
      const auto both = matrix.dots(level.scratch.data(), residual.data(), level.image.data());
      put(1, both[0]);
      put(2, both[1]);
    }
    if (matrix.level().distributed) sum_in_place(matrix.level().comm, sums);
    Scalars beta, alpha;
    for (int lane = 0; lane < Width; ++lane) {
      beta[lane] = energy[lane] > 0.0 ? -sums[2 * Width + lane] / energy[lane] : 0.0;
      energy[lane] = sums[lane] + beta[lane] * sums[2 * Width + lane];
      alpha[lane] = energy[lane] > 0.0 ? sums[Width + lane] / energy[lane] : 0.0;
    }
    if (step == 0)
      advance<true>(level, alpha, beta, steps == 1);
    else
      advance<false>(level, alpha, beta, step + 1 == steps);
  }
}

template <class Problem, int Width, class Real>
template <bool First>
void LaneMultigrid<Problem, Width, Real>::advance(Level& level, const Scalars& alpha, const Scalars& beta,
                                                  bool last) {
  using Value = Lanes<Width, Real>;
  const auto length = Value::load(alpha.data()), momentum = Value::load(beta.data());
  for (std::size_t i = 0; i < level.solution.size(); i += Width) {
    auto direction = Value::load(&level.scratch[i]);
    if constexpr (!First) direction += momentum * Value::load(&level.direction[i]);
    auto change = length * direction;
    if constexpr (!First) change += Value::load(&level.solution[i]);
    direction.store(&level.direction[i]);
    change.store(&level.solution[i]);
  }
  if (last) return;
  const Array& residual = First ? level.right : level.cg_residual;
  for (std::size_t i = 0; i < level.cg_residual.size(); i += Width) {
    auto image = Value::load(&level.product[i]);
    if constexpr (!First) image += momentum * Value::load(&level.image[i]);
    image.store(&level.image[i]);
    (Value::load(&residual[i]) - length * image).store(&level.cg_residual[i]);
  }
}

/// Every rank solves the lanes that it has factored.
template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::solve_directly() {
  Level& last = levels_.back();
  const MPI_Comm comm = hierarchy_.level(0).comm;
  const auto& rows = numbering_.rows();
  direct_values_.assign(rows.size() * Width, 0.0);
  // Lanes with factors of their own are solved one by one, the others side by side.
  const auto place = [&](std::size_t unknown, int lane) {
    return Problem::own_operators ? lane * rows.size() + rows[unknown] : rows[unknown] * Width + lane;
  };
  const auto has = [&](int lane) { return factors_[Problem::own_operators ? lane : 0] != nullptr; };
  for (std::size_t unknown = 0; unknown < rows.size(); ++unknown)
    for (int lane = 0; lane < Width; ++lane)
      if (has(lane)) direct_values_[place(unknown, lane)] = last.right[unknown * Width + lane];
  if constexpr (Problem::own_operators) {
    for (int lane = 0; lane < Width; ++lane)
      if (has(lane)) factors_[lane]->solve({direct_values_.data() + lane * rows.size(), rows.size()});
  } else if (has(0)) {
    factors_[0]->template solve_lanes<Width>(direct_values_);
  }
  if (Problem::own_operators && size_of(comm) > 1) sum_in_place(comm, direct_values_);
  for (std::size_t unknown = 0; unknown < rows.size(); ++unknown)
    for (int lane = 0; lane < Width; ++lane)
      last.solution[unknown * Width + lane] = static_cast<Real>(direct_values_[place(unknown, lane)]);
  last.matrix->clear_held(last.solution.data());
}

}  // namespace fabseq
