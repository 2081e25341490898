// SPDX-License-Identifier: MIT
#include "fabseq/solve/reference/preconditioner.h"

#include <array>
#include <map>

namespace fabseq {

namespace {

/// A factorization beats multigrid up to about this many unknowns (docs/developer/measuring.md).
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
/// Transform that is taken once the other was too small.
constexpr const char* safest_transform = "0,0.1,0,3";

/// Sets a PETSc option to its value for systems that are not relaxed: the user's, or else `value`. Kept, for
/// the option itself may since have been set for a relaxed system, and the next one shall begin like the
/// first. Asking for it marks it as read.
void set_normal_option(const std::string& name, const char* value) {
  static std::map<std::string, std::string> values;
  const auto [normal, is_new] = values.try_emplace(name, value);
  PetscBool given = PETSC_FALSE;
  if (is_new) {
    std::array<char, 256> text{};
    check(PetscOptionsGetString(nullptr, nullptr, name.c_str(), text.data(), text.size(), &given));
    if (given == PETSC_TRUE) normal->second = text.data();
  }
  check(PetscOptionsSetValue(nullptr, name.c_str(), normal->second.c_str()));
  check(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &given));
}

/// Rigid-body modes, or constants for one component.
template <int Dim>
NullSpaceHandle near_null_space(Mat matrix, const UnknownNumbering<Dim>& numbering) {
  NullSpaceHandle result;
  const auto& grid = numbering.grid;
  if (numbering.components == 1) {
    check(MatNullSpaceCreate(grid.comm(), PETSC_TRUE, 0, nullptr, result.receive()));
    return result;
  }
  VecHandle coordinates;
  check(MatCreateVecs(matrix, coordinates.receive(), nullptr));
  check(VecSetBlockSize(coordinates, Dim));
  PetscScalar* values = nullptr;
  check(VecGetArray(coordinates, &values));
  std::size_t position = 0;
  for (const int node : numbering.owned_nodes)
    for (const double x : grid.node_position(grid.owned_nodes().index(node))) values[position++] = x;
  check(VecRestoreArray(coordinates, &values));
  check(MatNullSpaceCreateRigidBody(coordinates, result.receive()));
  return result;
}

template <int Dim>
void set_up_gamg(PC pc, Mat matrix, const UnknownNumbering<Dim>& numbering, bool safe) {
  check(PCSetType(pc, PCGAMG));
  PetscReal threshold = safe ? 0.0 : gamg_threshold;
  check(PCGAMGSetThreshold(pc, &threshold, 1));
  if (safe) check(PCGAMGSetNSmooths(pc, 0));
  check(MatSetNearNullSpace(matrix, near_null_space(matrix, numbering)));
}

template <int Dim>
void set_up_multigrid(PC pc, const UnknownNumbering<Dim>& numbering) {
  const std::vector<MatHandle> interpolations = make_interpolations(numbering, coarsest_nodes);
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

void set_up_direct(PC pc) {
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  check(PCFactorSetUpMatSolverType(pc));
  Mat factor = nullptr;
  check(PCFactorGetMatrix(pc, &factor));
  // MUMPS' own estimate of its workspace is too small for some small systems on several ranks.
  check(MatMumpsSetIcntl(factor, 14, 200));
}

}  // namespace

template <int Dim>
ReferenceMethod usable_method(ReferenceMethod wanted, const UnknownNumbering<Dim>& numbering) {
  if (wanted == ReferenceMethod::multigrid) {
    // One level would be the smoother alone.
    if (!coarsening_obstacle(numbering.grid).empty()) return ReferenceMethod::gamg;
    return numbering.count > coarsest_nodes ? wanted : ReferenceMethod::direct;
  }
  if (wanted != ReferenceMethod::automatic) return wanted;
  if (numbering.count * numbering.components <= direct_limit<Dim>) return ReferenceMethod::direct;
  const std::vector<MatHandle> interpolations = make_interpolations(numbering, coarsest_nodes);
  if (interpolations.empty()) return ReferenceMethod::gamg;
  PetscInt coarsest = 0;
  check(MatGetSize(interpolations.back(), nullptr, &coarsest));
  return coarsest <= coarsest_limit * numbering.components ? ReferenceMethod::multigrid
                                                           : ReferenceMethod::gamg;
}

/// What makes multigrid fast makes its preconditioner indefinite in some graded layers. Geometric multigrid
/// is safe with the smoother's eigenvalues enlarged further; GAMG, without dropping weak couplings and
/// without smoothing the aggregates.
template <int Dim>
void set_up_preconditioner(KSP solver, Mat matrix, const UnknownNumbering<Dim>& numbering,
                           ReferenceMethod method, bool safe) {
  PC pc = nullptr;
  check(KSPGetPC(solver, &pc));
  if (method == ReferenceMethod::direct) return set_up_direct(pc);
  const char* prefix = nullptr;
  check(KSPGetOptionsPrefix(solver, &prefix));
  const std::string transform = std::string("-") + prefix + "mg_levels_ksp_chebyshev_esteig";
  if (method == ReferenceMethod::multigrid && safe)
    check(PetscOptionsSetValue(nullptr, transform.c_str(), safest_transform));
  else
    set_normal_option(transform, chebyshev_transform);
  if (method == ReferenceMethod::multigrid)
    set_up_multigrid(pc, numbering);
  else
    set_up_gamg(pc, matrix, numbering, safe);
}

void require_solver_options(const std::vector<std::string>& prefixes) {
  for (const std::string& prefix : prefixes) {
    KspHandle solver;
    check(KSPCreate(PETSC_COMM_WORLD, solver.receive()));
    check(KSPSetType(solver, KSPCG));
    check(KSPSetOptionsPrefix(solver, prefix.c_str()));
    check_options(KSPSetFromOptions(solver));
  }
}

FABSEQ_INSTANTIATE_FUNCTION(usable_method);
FABSEQ_INSTANTIATE_FUNCTION(set_up_preconditioner);

}  // namespace fabseq
