// SPDX-License-Identifier: MIT
/// \file
/// Definitions of LaneMultigrid, for the files that instantiate it.
#pragma once

#include "fabseq/base/mpi.h"
#include "multigrid/lane_multigrid.h"

#include <algorithm>

namespace fabseq {

template <class Problem, int Width, class Real>
LaneMultigrid<Problem, Width, Real>::LaneMultigrid(LaneHierarchy<dim>& hierarchy, const Problem& problem,
                                                   const LaneCycle& cycle)
    : hierarchy_(hierarchy), cycle_(cycle), direct_(hierarchy) {
  for (int index = 0; index < hierarchy.count(); ++index) {
    Level& level = levels_.emplace_back();
    level.matrix = std::make_unique<Operator>(hierarchy.level(index), problem);
    const std::size_t size = level.matrix->size();
    const bool last = index + 1 == hierarchy.count();
    const bool iterated = !last && index > 0 && std::max(steps_on(index, false), steps_on(index, true)) > 1;
    if (!last) {
      level.residual.resize(size);
      level.step.resize(size);
    }
    if (index > 0 && !hierarchy.level(index).lanes_dealt) {
      level.right.resize(size);
      level.solution.resize(size);
    }
    if (index > 0 && hierarchy.level(index - 1).staged)
      for (Array* array : {&level.stage_right, &level.stage_solution})
        array->resize(static_cast<std::size_t>(hierarchy.level(index - 1).stage.nodes()) * node_values);
    for (Array* array : {&level.cg_residual, &level.direction, &level.image, &level.scratch, &level.product})
      if (iterated) array->resize(size);
  }
}

template <class Problem, int Width, class Real>
std::array<bool, Width> LaneMultigrid<Problem, Width, Real>::set_up() {
  for (int level = 0; level + 1 < hierarchy_.count(); ++level) {
    levels_[level].matrix->set_up();
    coarsen_coefficients(level);
  }
  return direct_.factor(*levels_.back().matrix, cycle_.shift);
}

/// Sums of what ranks share go to those that hold it: for a last level that is dealt out, to all.
template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::coarsen_coefficients(int level) {
  constexpr int stride = Operator::Kernel::stride;
  LaneLevel<dim>& fine = hierarchy_.level(level);
  const LaneLevel<dim>& coarse = hierarchy_.level(level + 1);
  const Array& from = levels_[level].matrix->coefficients();
  Array& to = levels_[level + 1].matrix->coefficients();
  Array on_stage;
  if (fine.staged && !coarse.lanes_dealt)
    on_stage.resize(static_cast<std::size_t>(fine.stage.elements()) * stride);
  Array& parts = fine.staged && !coarse.lanes_dealt ? on_stage : to;
  std::fill(to.begin(), to.end(), Real{0});
  Real share{1};
  for (const int factor : fine.factors) share /= static_cast<Real>(factor);
  for (std::size_t element = 0; element < fine.parent.size(); ++element)
    for (int i = 0; i < stride; ++i)
      parts[fine.parent[element] * stride + i] += share * from[element * stride + i];
  if (coarse.lanes_dealt)
    sum_in_place(hierarchy_.level(0).comm, std::span<Real>(to));
  else if (fine.staged)
    fine.gather.add_elements(on_stage.data(), to.data(), stride);
}

template <class Problem, int Width, class Real>
template <int Wider>
void LaneMultigrid<Problem, Width, Real>::select(LaneMultigrid<Problem, Wider, Real>& from,
                                                 std::span<const int> lanes) {
  for (std::size_t level = 0; level < levels_.size(); ++level)
    levels_[level].matrix->template select<Wider>(*from.levels_[level].matrix, lanes);
  direct_.template select<Wider>(from.direct_, lanes);
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::visit(int index, const Real* b, Real* x) {
  Level& level = levels_[index];
  if (index + 1 == hierarchy_.count()) {
    if (index == 0) direct_.solve(*level.matrix, b, x);
    return;
  }
  level.matrix->smooth(b, x, level.step.data(), cycle_.degree, true);
  level.matrix->residual_part(b, x, level.residual.data());
  restrict_residual(index);
  solve(index + 1);
  prolong(index, x);
  level.matrix->clear_held(x);
  level.matrix->smooth(b, x, level.step.data(), cycle_.degree, false);
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::restrict_residual(int index) {
  LaneLevel<dim>& fine = hierarchy_.level(index);
  LaneLevel<dim>& coarse = hierarchy_.level(index + 1);
  Level& below = levels_[index + 1];
  Array& parts = right_of_parts(index + 1);
  std::fill(parts.begin(), parts.end(), Real{0});
  fine.transfer.template restrict_add<components, Width>(levels_[index].residual.data(), parts.data());
  if (coarse.lanes_dealt) return;  // LaneDirect sums them at their owners
  if (fine.staged) {
    std::fill(below.right.begin(), below.right.end(), Real{0});
    fine.gather.add_nodes(parts.data(), below.right.data(), node_values);
  }
  sum_over_holders(coarse, below.right.data(), node_values);
  below.matrix->clear_held(below.right.data());
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::prolong(int index, Real* x) {
  LaneLevel<dim>& fine = hierarchy_.level(index);
  Array& parts = solution_of_parts(index + 1);
  if (fine.staged && !hierarchy_.level(index + 1).lanes_dealt)
    fine.gather.fetch_nodes(levels_[index + 1].solution.data(), parts.data(), node_values);
  fine.transfer.template prolong_add<components, Width>(parts.data(), x);
}

template <class Problem, int Width, class Real>
void LaneMultigrid<Problem, Width, Real>::solve(int index) {
  const int steps = steps_on(index, patient_);
  if (index + 1 == hierarchy_.count())
    direct_.solve(*levels_[index].matrix, right_of_parts(index).data(), solution_of_parts(index).data());
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
  Scalars energy{};  // p . K p
  for (int step = 0; step < steps; ++step) {
    const Array& residual = step == 0 ? level.right : level.cg_residual;
    visit(index, residual.data(), level.scratch.data());
    std::array<Scalars, 3> sums{matrix.apply(level.scratch.data(), level.product.data())};
    auto& [own, decrease, overlap] = sums;  // z . w, z . r, z . q
    if (step == 0) {
      decrease = matrix.dot(level.scratch.data(), residual.data());
    } else {
      const auto both = matrix.dots(level.scratch.data(), residual.data(), level.image.data());
      decrease = both[0];
      overlap = both[1];
    }
    if (matrix.level().distributed)
      sum_in_place(matrix.level().comm, std::span<double>(sums.front().data(), 3 * Width));
    Scalars beta, alpha;
    for (int lane = 0; lane < Width; ++lane) {
      beta[lane] = energy[lane] > 0.0 ? -overlap[lane] / energy[lane] : 0.0;
      energy[lane] = own[lane] + beta[lane] * overlap[lane];
      alpha[lane] = energy[lane] > 0.0 ? decrease[lane] / energy[lane] : 0.0;
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

}  // namespace fabseq
