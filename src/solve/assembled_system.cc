#include "fabseq/solve/assembled_system.h"

#include "fabseq/base/log_event.h"
#include "fabseq/solve/interpolation.h"

#include <algorithm>

namespace fabseq {

namespace {

/// A factorization beats multigrid up to about this many unknowns (docs/performance.md).
template <int Dim>
constexpr std::int64_t direct_limit = Dim == 2 ? 200000 : 20000;
/// More nodes than this on the coarsest level are too many for a factorization on every rank.
constexpr PetscInt coarsest_limit = 4000;
/// Geometric multigrid stops coarsening at this many nodes.
constexpr std::int64_t coarsest_nodes = 400;
/// Couplings weaker than this are dropped from GAMG's graph.
constexpr double gamg_threshold = 0.01;
/// Estimated largest eigenvalues are enlarged by this factor, not by PETSc's 1.1: where stiffness jumps by
/// nine decades the estimate can fall short by more than that, and the smoother, and with it the
/// preconditioner, becomes indefinite.
constexpr const char* chebyshev_transform = "0,0.1,0,1.5";
/// And by this one once the other was too small.
constexpr const char* safest_transform = "0,0.1,0,3";

/// Sets a PETSc option unless the user did. Asking for it marks it as read.
void set_default_option(const std::string& name, const char* value) {
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &given));
  if (given == PETSC_FALSE) check(PetscOptionsSetValue(nullptr, name.c_str(), value));
  check(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &given));
}

}  // namespace

template <int Dim>
AssembledSystem<Dim>::AssembledSystem(const SystemDomain& domain,
                                      std::shared_ptr<const UnknownNumbering<Dim>> numbering,
                                      const AssembledSolverSettings& settings)
    : domain_(domain), numbering_(std::move(numbering)), settings_(settings), method_(settings.method) {
  if (method_ == ReferenceMethod::automatic) method_ = preferred_method(*numbering_);
  create_matrix();
  create_solver();
}

template <int Dim>
ReferenceMethod AssembledSystem<Dim>::preferred_method(const UnknownNumbering<Dim>& numbering) {
  if (numbering.count() * numbering.components() <= direct_limit<Dim>) return ReferenceMethod::direct;
  const std::vector<MatHandle> interpolations = make_interpolations(numbering, coarsest_nodes);
  if (interpolations.empty()) return ReferenceMethod::gamg;
  PetscInt coarsest = 0;
  check(MatGetSize(interpolations.back(), nullptr, &coarsest));
  return coarsest <= coarsest_limit * numbering.components() ? ReferenceMethod::multigrid
                                                             : ReferenceMethod::gamg;
}

template <int Dim>
void AssembledSystem<Dim>::create_matrix() {
  const int block = numbering_->components();
  const auto rows = static_cast<PetscInt>(numbering_->owned_nodes().size());
  const auto& grid = numbering_->grid();
  // A node couples to at most 3^Dim nodes: count those that are unknowns, here or on other ranks.
  std::vector<PetscInt> own(rows, 0), other(rows, 0);
  const auto first = static_cast<PetscInt>(numbering_->first());
  for (PetscInt row = 0; row < rows; ++row) {
    const Index<Dim> node = grid.owned_nodes().index(numbering_->owned_nodes()[row]);
    IndexBox<Dim> neighbours;
    for (int axis = 0; axis < Dim; ++axis) {
      neighbours.start[axis] = std::max(node[axis] - 1, 0);
      neighbours.size[axis] =
          std::min(node[axis] + 1, grid.domain().elements[axis]) + 1 - neighbours.start[axis];
    }
    neighbours.for_each([&](const Index<Dim>& neighbour, std::int64_t) {
      const PetscInt number = numbering_->numbers()[grid.ghosted_nodes().offset(neighbour)];
      if (number >= first && number < first + rows)
        ++own[row];
      else if (number >= 0)
        ++other[row];
    });
  }
  check(MatCreate(grid.comm(), matrix_.receive()));
  check(MatSetSizes(matrix_, rows * block, rows * block, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(matrix_, MATAIJ));
  check(MatSetBlockSize(matrix_, block));
  check(MatXAIJSetPreallocation(matrix_, block, own.data(), other.data(), nullptr, nullptr));
  check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(matrix_, solution_.receive(), load_.receive()));
}

template <int Dim>
void AssembledSystem<Dim>::create_solver() {
  check(KSPCreate(numbering_->grid().comm(), solver_.receive()));
  check(KSPSetType(solver_, KSPCG));
  check(KSPSetNormType(solver_, KSP_NORM_PRECONDITIONED));
  check(KSPSetTolerances(solver_, settings_.tolerance, 1e-300, 1e30, settings_.max_iterations));
  check(KSPSetResidualHistory(solver_, nullptr, PETSC_DECIDE, PETSC_TRUE));
  check(KSPSetOptionsPrefix(solver_, settings_.options_prefix.c_str()));
  check(KSPSetOperators(solver_, matrix_, matrix_));
  PC pc = nullptr;
  check(KSPGetPC(solver_, &pc));
  const std::string transform_option = "-" + settings_.options_prefix + "mg_levels_ksp_chebyshev_esteig";
  if (method_ == ReferenceMethod::multigrid && relaxed_)
    check(PetscOptionsSetValue(nullptr, transform_option.c_str(), safest_transform));
  else if (method_ != ReferenceMethod::direct)
    set_default_option(transform_option, chebyshev_transform);
  switch (method_) {
    case ReferenceMethod::multigrid:
      set_up_multigrid(pc);
      break;
    case ReferenceMethod::direct:
      set_up_direct(pc);
      break;
    default:
      set_up_gamg(pc);
  }
  check(KSPSetFromOptions(solver_));
}

template <int Dim>
void AssembledSystem<Dim>::set_up_gamg(PC pc) {
  check(PCSetType(pc, PCGAMG));
  PetscReal threshold = relaxed_ ? 0.0 : gamg_threshold;
  check(PCGAMGSetThreshold(pc, &threshold, 1));
  if (relaxed_) check(PCGAMGSetNSmooths(pc, 0));
  check(MatSetNearNullSpace(matrix_, near_null_space()));
}

template <int Dim>
NullSpaceHandle AssembledSystem<Dim>::near_null_space() const {
  NullSpaceHandle result;
  const auto& grid = numbering_->grid();
  if (numbering_->components() == 1) {
    check(MatNullSpaceCreate(grid.comm(), PETSC_TRUE, 0, nullptr, result.receive()));
    return result;
  }
  VecHandle coordinates;
  check(VecDuplicate(load_, coordinates.receive()));
  check(VecSetBlockSize(coordinates, Dim));
  PetscScalar* values = nullptr;
  check(VecGetArray(coordinates, &values));
  std::size_t position = 0;
  for (const int node : numbering_->owned_nodes())
    for (const double x : grid.node_position(grid.owned_nodes().index(node))) values[position++] = x;
  check(VecRestoreArray(coordinates, &values));
  check(MatNullSpaceCreateRigidBody(coordinates, result.receive()));
  return result;
}

template <int Dim>
void AssembledSystem<Dim>::set_up_multigrid(PC pc) {
  const std::vector<MatHandle> interpolations = make_interpolations(*numbering_, coarsest_nodes);
  const auto levels = static_cast<PetscInt>(interpolations.size()) + 1;
  check(PCSetType(pc, PCMG));
  check(PCMGSetLevels(pc, levels, nullptr));
  check(PCMGSetGalerkin(pc, PC_MG_GALERKIN_BOTH));
  for (PetscInt level = 1; level < levels; ++level) {
    check(PCMGSetInterpolation(pc, level, interpolations[levels - 1 - level]));
    KSP smoother = nullptr;
    PC jacobi = nullptr;
    check(PCMGGetSmoother(pc, level, &smoother));
    check(KSPSetType(smoother, KSPCHEBYSHEV));
    check(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 4));
    check(KSPGetPC(smoother, &jacobi));
    check(PCSetType(jacobi, PCJACOBI));
  }
  // The coarsest level keeps PCMG's default, a (redundant) LU factorization with a shift: coarse nodes beside
  // a thin wall may depend on each other.
}

template <int Dim>
void AssembledSystem<Dim>::set_up_direct(PC pc) {
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  check(PCFactorSetUpMatSolverType(pc));
  Mat factor = nullptr;
  check(PCFactorGetMatrix(pc, &factor));
  // MUMPS' own estimate of its workspace is too small for some small systems on several ranks.
  check(MatMumpsSetIcntl(factor, 14, 200));
}

template <int Dim>
void AssembledSystem<Dim>::assemble(std::initializer_list<Term> terms) {
  static const LogEvent event("fabseq set-up");
  const auto scope = event.enter();
  const auto& grid = numbering_->grid();
  constexpr int corners = corner_count<Dim>;
  const std::size_t entries = terms.begin()->matrix.size();
  std::vector<double> element_matrix(entries);
  std::array<PetscInt, corners> nodes{};
  check(MatZeroEntries(matrix_));
  for (std::size_t element = 0; element < domain_.first_corners.size(); ++element) {
    std::fill(element_matrix.begin(), element_matrix.end(), 0.0);
    for (const Term& term : terms) {
      const double coefficient = term.coefficients.empty() ? 1.0 : term.coefficients[element];
      for (std::size_t i = 0; i < entries; ++i) element_matrix[i] += coefficient * term.matrix[i];
    }
    // Negative numbers, the nodes that are no unknowns, are skipped by PETSc.
    for (int corner = 0; corner < corners; ++corner)
      nodes[corner] = numbering_->numbers()[domain_.first_corners[element] + grid.corner_offsets()[corner]];
    check(MatSetValuesBlocked(matrix_, corners, nodes.data(), corners, nodes.data(), element_matrix.data(),
                              ADD_VALUES));
  }
  check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
  const auto& fixed = numbering_->fixed_rows();
  check(
      MatZeroRowsColumns(matrix_, static_cast<PetscInt>(fixed.size()), fixed.data(), 1.0, nullptr, nullptr));
  // GAMG cannot change the sizes of its levels in place.
  if (method_ == ReferenceMethod::gamg) create_solver();
  check(KSPSetUp(solver_));
}

template <int Dim>
SolveReport AssembledSystem<Dim>::solve(std::span<const double> load, std::span<double> solution) {
  static const LogEvent event("fabseq solve");
  const auto scope = event.enter();
  const int block = numbering_->components();
  const auto& nodes = numbering_->owned_nodes();
  PetscScalar* values = nullptr;
  check(VecGetArray(load_, &values));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int c = 0; c < block; ++c) {
      const std::size_t unknown = static_cast<std::size_t>(nodes[i]) * block + c;
      values[i * block + c] = domain_.fixed[unknown] != 0 ? 0.0 : load[unknown];
    }
  check(VecRestoreArray(load_, &values));
  std::fill(solution.begin(), solution.end(), 0.0);
  PetscReal size = 0.0;
  check(VecNorm(load_, NORM_INFINITY, &size));
  if (size == 0.0) return {};

  check(KSPSolve(solver_, load_, solution_));
  SolveReport report = last_report();
  if (!report.converged && relax()) {
    check(KSPSolve(solver_, load_, solution_));
    report = last_report();
  }

  const PetscScalar* result = nullptr;
  check(VecGetArrayRead(solution_, &result));
  // Aggregates couple a node's components: rounding reaches fixed ones, too.
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int c = 0; c < block; ++c) {
      const std::size_t unknown = static_cast<std::size_t>(nodes[i]) * block + c;
      solution[unknown] = domain_.fixed[unknown] != 0 ? 0.0 : result[i * block + c];
    }
  check(VecRestoreArrayRead(solution_, &result));
  return report;
}

template <int Dim>
SolveReport AssembledSystem<Dim>::last_report() const {
  SolveReport report;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(solver_, &reason));
  check(KSPGetIterationNumber(solver_, &report.iterations));
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

/// What makes multigrid fast makes its preconditioner indefinite in some graded layers. Geometric multigrid then enlarges the
/// smoother's eigenvalues further; GAMG does without dropping weak couplings and without smoothing the aggregates: slower and safe.
template <int Dim>
bool AssembledSystem<Dim>::relax() {
  if (method_ == ReferenceMethod::direct || relaxed_) return false;
  relaxed_ = true;
  create_solver();
  check(KSPSetUp(solver_));
  return true;
}

template class AssembledSystem<2>;
template class AssembledSystem<3>;

}  // namespace fabseq
