// SPDX-License-Identifier: MIT
#include "fabseq/solve/reference/assembled_system.h"

#include "fabseq/base/log_event.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/stop.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Right-hand sides a factorization takes at a time: as many as MUMPS works on at once, and no more memory.
constexpr std::size_t block_columns = 32;
/// Iterations between two questions whether to stop.
constexpr PetscInt poll_interval = 10;

/// PETSc's own convergence test, which also ends where a rank has been asked to stop.
PetscErrorCode converged_or_stopped(KSP solver, PetscInt iteration, PetscReal norm,
                                    KSPConvergedReason* reason, void* context) {
  PetscFunctionBegin;
  PetscCall(KSPConvergedDefault(solver, iteration, norm, reason, context));
  if (*reason == KSP_CONVERGED_ITERATING && iteration % poll_interval == poll_interval - 1 &&
      any(PetscObjectComm(reinterpret_cast<PetscObject>(solver)), stop_requested()))
    *reason = KSP_DIVERGED_BREAKDOWN;
  PetscFunctionReturn(0);
}

/// How the solve of a block of columns ended.
struct BlockReport {
  int iterations = 0;             ///< of all columns
  std::vector<double> residuals;  ///< of each column, preconditioned, over a zero start's; 0 of a zero one
};

/// The first iteration of an exact solve gains all the digits there are; rounding may want a second one.
constexpr int most_block_iterations = 3;

std::vector<double> column_norms(Mat matrix) {
  PetscInt columns = 0;
  check(MatGetSize(matrix, nullptr, &columns));
  std::vector<double> norms(columns);
  check(MatGetColumnNorms(matrix, NORM_2, norms.data()));
  return norms;
}

/// Solves for all columns of a dense matrix at once: solutions = M^-1 loads, iterated until the residuals are
/// at `tolerance`. M, the preconditioner of `solver`, is set up and a factorization: after two or three
/// iterations a column above the tolerance is the caller's to solve by `solver` itself. PETSc's own
/// KSPMatSolve takes the columns one by one for every method that measures a residual, and forgets how all
/// but the last ended. Collective.
BlockReport solve_block(KSP solver, Mat loads, Mat solutions, double tolerance) {
  PC pc = nullptr;
  Mat matrix = nullptr;
  check(KSPGetPC(solver, &pc));
  check(KSPGetOperators(solver, &matrix, nullptr));
  MatHandle residuals, corrections;
  check(MatDuplicate(loads, MAT_DO_NOT_COPY_VALUES, residuals.receive()));
  check(MatDuplicate(loads, MAT_DO_NOT_COPY_VALUES, corrections.receive()));

  check(PCMatApply(pc, loads, solutions));
  const std::vector<double> start = column_norms(solutions);
  BlockReport report;
  while (true) {
    ++report.iterations;
    Mat products = residuals;
    check(MatMatMult(matrix, solutions, MAT_REUSE_MATRIX, PETSC_DEFAULT, &products));
    check(MatAYPX(residuals, -1.0, loads, SAME_NONZERO_PATTERN));
    check(PCMatApply(pc, residuals, corrections));
    report.residuals = column_norms(corrections);
    bool solved = true;
    for (std::size_t column = 0; column < start.size(); ++column) {
      if (start[column] > 0.0) report.residuals[column] /= start[column];
      solved = solved && report.residuals[column] <= tolerance;
    }
    if (solved || report.iterations == most_block_iterations) return report;
    check(MatAXPY(solutions, 1.0, corrections, SAME_NONZERO_PATTERN));
  }
}

}  // namespace

template <int Dim>
AssembledSystem<Dim>::AssembledSystem(const SystemDomain& domain,
                                      std::shared_ptr<const UnknownNumbering<Dim>> numbering,
                                      const AssembledSolverSettings& settings)
    : domain_(domain),
      numbering_(std::move(numbering)),
      settings_(settings),
      method_(usable_method(settings.method, *numbering_)) {
  create_matrix();
  create_solver();
}

template <int Dim>
void AssembledSystem<Dim>::create_matrix() {
  const int components = numbering_->components;
  const auto rows = static_cast<PetscInt>(numbering_->owned_nodes.size());
  const auto& grid = numbering_->grid;
  // A node couples to at most 3^Dim nodes: count those that are unknowns, here or on other ranks.
  std::vector<PetscInt> own(rows, 0), other(rows, 0);
  const auto first = static_cast<PetscInt>(numbering_->first);
  for (PetscInt row = 0; row < rows; ++row) {
    const Index<Dim> node = grid.owned_nodes().index(numbering_->owned_nodes[row]);
    const IndexBox<Dim> around = ringed(IndexBox<Dim>{node, uniform_index<Dim>(1)});
    around.common_with(grid.all_nodes()).for_each([&](const Index<Dim>& neighbour, std::int64_t) {
      const PetscInt number = numbering_->numbers[grid.ghosted_nodes().offset(neighbour)];
      if (number >= first && number < first + rows)
        ++own[row];
      else if (number >= 0)
        ++other[row];
    });
  }
  check(MatCreate(grid.comm(), matrix_.receive()));
  check(MatSetSizes(matrix_, rows * components, rows * components, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(matrix_, MATAIJ));
  check(MatSetBlockSize(matrix_, components));
  check(MatXAIJSetPreallocation(matrix_, components, own.data(), other.data(), nullptr, nullptr));
  check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(matrix_, solution_.receive(), load_.receive()));
}

template <int Dim>
void AssembledSystem<Dim>::create_solver() {
  check(KSPCreate(numbering_->grid.comm(), solver_.receive()));
  check(KSPSetType(solver_, KSPCG));
  check(KSPSetNormType(solver_, KSP_NORM_PRECONDITIONED));
  check(KSPSetTolerances(solver_, settings_.tolerance, 1e-300, 1e30, settings_.max_iterations));
  void* test = nullptr;
  check(KSPConvergedDefaultCreate(&test));
  check(KSPSetConvergenceTest(solver_, converged_or_stopped, test, KSPConvergedDefaultDestroy));
  check(KSPSetResidualHistory(solver_, nullptr, PETSC_DECIDE, PETSC_TRUE));
  check(KSPSetOptionsPrefix(solver_, settings_.options_prefix.c_str()));
  check(KSPSetOperators(solver_, matrix_, matrix_));
  set_up_preconditioner(solver_, matrix_, *numbering_, method_, relaxed_);
  check_options(KSPSetFromOptions(solver_));
}

template <int Dim>
void AssembledSystem<Dim>::set_tolerance(double tolerance) {
  // What options have set lasts.
  if (tolerance == settings_.tolerance) return;
  settings_.tolerance = tolerance;
  check(KSPSetTolerances(solver_, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
}

template <int Dim>
void AssembledSystem<Dim>::add_diagonal(std::span<const double> diagonal) {
  auto row = static_cast<PetscInt>(numbering_->first);
  for (const int node : numbering_->owned_nodes) {
    check(MatSetValue(matrix_, row, row, diagonal[node], ADD_VALUES));
    ++row;
  }
}

template <int Dim>
void AssembledSystem<Dim>::assemble(std::initializer_list<Term> terms, std::span<const double> diagonal) {
  static const LogEvent event("fabseq set-up");
  const auto scope = event.enter();
  const auto& grid = numbering_->grid;
  constexpr int corners = corner_count<Dim>;
  const std::size_t entries = terms.begin()->matrix.size();
  std::vector<double> element_matrix(entries);
  std::array<PetscInt, corners> nodes{};
  check(MatZeroEntries(matrix_));
  for (std::size_t element = 0; element < domain_.first_corners.size(); ++element) {
    std::fill(element_matrix.begin(), element_matrix.end(), 0.0);
    for (const Term& term : terms)
      for (std::size_t i = 0; i < entries; ++i)
        element_matrix[i] += term.coefficients[element] * term.matrix[i];
    // Negative numbers, the nodes that are no unknowns, are skipped by PETSc.
    for (int corner = 0; corner < corners; ++corner)
      nodes[corner] = numbering_->numbers[domain_.first_corners[element] + grid.corner_offsets()[corner]];
    check(MatSetValuesBlocked(matrix_, corners, nodes.data(), corners, nodes.data(), element_matrix.data(),
                              ADD_VALUES));
  }
  if (!diagonal.empty()) add_diagonal(diagonal);
  check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
  const auto& fixed = numbering_->fixed_rows;
  check(
      MatZeroRowsColumns(matrix_, static_cast<PetscInt>(fixed.size()), fixed.data(), 1.0, nullptr, nullptr));
  // GAMG cannot change the sizes of its levels in place.
  if (method_ == ReferenceMethod::gamg) create_solver();
  check(KSPSetUp(solver_));
}

template <int Dim>
void AssembledSystem<Dim>::gather_load(std::span<const double> load, PetscScalar* values) const {
  const int components = numbering_->components;
  std::size_t position = 0;
  for (const int node : numbering_->owned_nodes)
    for (int c = 0; c < components; ++c) {
      const std::size_t unknown = static_cast<std::size_t>(node) * components + c;
      values[position++] = domain_.fixed[unknown] != 0 ? 0.0 : load[unknown];
    }
}

/// Aggregates couple a node's components: rounding reaches fixed ones, too.
template <int Dim>
void AssembledSystem<Dim>::scatter_solution(const PetscScalar* values, std::span<double> solution) const {
  const int components = numbering_->components;
  std::fill(solution.begin(), solution.end(), 0.0);
  std::size_t position = 0;
  for (const int node : numbering_->owned_nodes)
    for (int c = 0; c < components; ++c, ++position) {
      const std::size_t unknown = static_cast<std::size_t>(node) * components + c;
      if (domain_.fixed[unknown] == 0) solution[unknown] = values[position];
    }
}

template <int Dim>
SolveReport AssembledSystem<Dim>::solve(std::span<const double> load, std::span<double> solution) {
  static const LogEvent event("fabseq solve");
  const auto scope = event.enter();
  PetscScalar* values = nullptr;
  check(VecGetArray(load_, &values));
  gather_load(load, values);
  check(VecRestoreArray(load_, &values));
  std::fill(solution.begin(), solution.end(), 0.0);
  PetscReal size = 0.0;
  check(VecNorm(load_, NORM_INFINITY, &size));
  if (size == 0.0) return {};

  const MPI_Comm comm = numbering_->grid.comm();
  stop_if_requested(comm);
  check(KSPSolve(solver_, load_, solution_));
  SolveReport report = last_report();
  if (!report.converged) stop_if_requested(comm);
  if (!report.converged && method_ != ReferenceMethod::direct && !relaxed_) {
    relaxed_ = true;
    create_solver();
    check(KSPSetUp(solver_));
    check(KSPSolve(solver_, load_, solution_));
    report = last_report();
  }
  const PetscScalar* result = nullptr;
  check(VecGetArrayRead(solution_, &result));
  scatter_solution(result, solution);
  check(VecRestoreArrayRead(solution_, &result));
  return report;
}

template <int Dim>
std::vector<SolveReport> AssembledSystem<Dim>::solve(std::span<const std::vector<double>> loads,
                                                     std::span<std::vector<double>> solutions) {
  std::vector<SolveReport> reports;
  while (reports.size() < loads.size()) {
    const std::size_t first = reports.size();
    const std::size_t count = std::min(block_columns, loads.size() - first);
    if (method_ == ReferenceMethod::direct && count > 1) {
      const auto block = solve_side_by_side(loads.subspan(first, count), solutions.subspan(first, count));
      reports.insert(reports.end(), block.begin(), block.end());
    } else {
      reports.push_back(solve(std::span<const double>(loads[first]), solutions[first]));
    }
  }
  return reports;
}

template <int Dim>
std::vector<SolveReport> AssembledSystem<Dim>::solve_side_by_side(std::span<const std::vector<double>> loads,
                                                                  std::span<std::vector<double>> solutions) {
  static const LogEvent event("fabseq block solve");
  const auto scope = event.enter();
  const std::size_t rows = numbering_->owned_nodes.size() * numbering_->components;
  const auto columns = static_cast<PetscInt>(loads.size());
  MatHandle load, solution;
  check(MatCreateDense(numbering_->grid.comm(), static_cast<PetscInt>(rows), PETSC_DECIDE, PETSC_DETERMINE,
                       columns, nullptr, load.receive()));
  check(MatDuplicate(load, MAT_DO_NOT_COPY_VALUES, solution.receive()));
  PetscScalar* values = nullptr;
  check(MatDenseGetArrayWrite(load, &values));
  for (PetscInt column = 0; column < columns; ++column) gather_load(loads[column], values + column * rows);
  check(MatDenseRestoreArrayWrite(load, &values));

  stop_if_requested(numbering_->grid.comm());
  const BlockReport block = solve_block(solver_, load, solution, settings_.tolerance);
  std::vector<SolveReport> reports;
  const PetscScalar* result = nullptr;
  check(MatDenseGetArrayRead(solution, &result));
  for (PetscInt column = 0; column < columns; ++column) {
    if (block.residuals[column] <= settings_.tolerance) {
      reports.push_back(
          {block.iterations, block.residuals[column], true, KSPConvergedReasons[KSP_CONVERGED_RTOL]});
      scatter_solution(result + column * rows, solutions[column]);
    } else {
      reports.push_back(solve(std::span<const double>(loads[column]), solutions[column]));
    }
  }
  check(MatDenseRestoreArrayRead(solution, &result));
  return reports;
}

template <int Dim>
SolveReport AssembledSystem<Dim>::last_report() const {
  SolveReport report;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(solver_, &reason));
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(solver_, &iterations));
  report.iterations = static_cast<int>(iterations);
  PetscReal norm = 0.0;
  check(KSPGetResidualNorm(solver_, &norm));
  const PetscReal* history = nullptr;
  PetscInt recorded = 0;
  check(KSPGetResidualHistory(solver_, &history, &recorded));
  report.residual = recorded > 0 && history[0] > 0.0 ? norm / history[0] : norm;
  report.converged = reason > 0;
  report.reason = KSPConvergedReasons[reason];
  return report;
}

FABSEQ_INSTANTIATE_CLASS(AssembledSystem);

}  // namespace fabseq
