// SPDX-License-Identifier: MIT
#include "fabseq/grid/grid.h"
#include "fabseq/grid/placed_array.h"

#include <algorithm>
#include <cassert>

namespace fabseq {

namespace {

/// Used in assertions only.
[[maybe_unused]] PetscInt local_size(Vec vector) {
  PetscInt size = 0;
  check(VecGetLocalSize(vector, &size));
  return size;
}

}  // namespace

template <int Dim>
NodeExchange<Dim>::NodeExchange(DM dm, int components) : dm_(dm) {
  std::array<PetscInt, 3> owned{}, ghosted{};
  check(DMDAGetCorners(dm, nullptr, nullptr, nullptr, &owned[0], &owned[1], &owned[2]));
  check(DMDAGetGhostCorners(dm, nullptr, nullptr, nullptr, &ghosted[0], &ghosted[1], &ghosted[2]));
  const auto values = [components](const std::array<PetscInt, 3>& size) {
    return components * size[0] * size[1] * size[2];
  };
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(dm), &comm));
  // Vectors without arrays of their own: they are lent the caller's.
  check(VecCreateMPIWithArray(comm, components, values(owned), PETSC_DETERMINE, nullptr, owned_.receive()));
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, components, values(ghosted), nullptr, ghosted_.receive()));
}

template <int Dim>
void NodeExchange<Dim>::to_ghosted(std::span<const double> owned, std::span<double> ghosted) const {
  assert(static_cast<PetscInt>(owned.size()) == local_size(owned_));
  assert(static_cast<PetscInt>(ghosted.size()) == local_size(ghosted_));
  const PlacedArray from(owned_, owned.data());
  const PlacedArray to(ghosted_, ghosted.data());
  check(DMGlobalToLocalBegin(dm_, owned_, INSERT_VALUES, ghosted_));
  check(DMGlobalToLocalEnd(dm_, owned_, INSERT_VALUES, ghosted_));
}

template <int Dim>
void NodeExchange<Dim>::add_to_owned(std::span<const double> ghosted, std::span<double> owned) const {
  assert(static_cast<PetscInt>(owned.size()) == local_size(owned_));
  assert(static_cast<PetscInt>(ghosted.size()) == local_size(ghosted_));
  std::fill(owned.begin(), owned.end(), 0.0);
  const PlacedArray from(ghosted_, ghosted.data());
  const PlacedArray to(owned_, owned.data());
  check(DMLocalToGlobalBegin(dm_, ghosted_, ADD_VALUES, owned_));
  check(DMLocalToGlobalEnd(dm_, ghosted_, ADD_VALUES, owned_));
}

FABSEQ_INSTANTIATE_CLASS(NodeExchange);

}  // namespace fabseq
