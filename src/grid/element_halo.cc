// SPDX-License-Identifier: MIT
#include "fabseq/grid/element_halo.h"

#include "fabseq/base/petsc.h"

#include <algorithm>
#include <cassert>

namespace fabseq {

namespace {

/// `box` extended by `width` at both ends of each axis, within the grid.
template <int Dim>
IndexBox<Dim> grown(const IndexBox<Dim>& box, const Index<Dim>& width, const Index<Dim>& elements) {
  IndexBox<Dim> result;
  for (int axis = 0; axis < Dim; ++axis) {
    // Widths are clipped before they are added, because a width may be anything up to the largest int.
    const int below = std::min(width[axis], box.start[axis]);
    const int above = std::min(width[axis], elements[axis] - box.start[axis] - box.size[axis]);
    result.start[axis] = box.start[axis] - below;
    result.size[axis] = below + box.size[axis] + above;
  }
  return result;
}

}  // namespace

template <int Dim>
ElementHalo<Dim>::ElementHalo(const Grid<Dim>& grid, const Index<Dim>& width)
    : box_(grown<Dim>(grid.owned_elements(), width, grid.domain().elements)) {
  const auto owned_count = static_cast<PetscInt>(grid.owned_elements().count());
  const auto box_count = static_cast<PetscInt>(box_.count());
  std::vector<PetscInt> numbers(static_cast<std::size_t>(box_count));
  box_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    numbers[offset] = static_cast<PetscInt>(grid.element_number(element));
  });
  // The vectors have no arrays of their own; they are lent those of the caller.
  check(VecCreateMPIWithArray(grid.comm(), 1, owned_count, PETSC_DETERMINE, nullptr, owned_.receive()));
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, box_count, nullptr, extended_.receive()));
  IndexSetHandle from, to;
  check(ISCreateGeneral(PETSC_COMM_SELF, box_count, numbers.data(), PETSC_USE_POINTER, from.receive()));
  check(ISCreateStride(PETSC_COMM_SELF, box_count, 0, 1, to.receive()));
  check(VecScatterCreate(owned_, from, extended_, to, scatter_.receive()));
}

template <int Dim>
std::vector<double> ElementHalo<Dim>::gather(std::span<const double> owned) const {
  std::vector<double> extended(static_cast<std::size_t>(box_.count()));
  const PlacedArray from(owned_, owned.data());
  const PlacedArray to(extended_, extended.data());
  check(VecScatterBegin(scatter_, owned_, extended_, INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(scatter_, owned_, extended_, INSERT_VALUES, SCATTER_FORWARD));
  return extended;
}

template <int Dim>
std::vector<double> ElementHalo<Dim>::scatter_add(std::span<const double> values) const {
  assert(static_cast<std::int64_t>(values.size()) == box_.count());
  PetscInt owned_count = 0;
  check(VecGetLocalSize(owned_, &owned_count));
  std::vector<double> owned(static_cast<std::size_t>(owned_count), 0.0);
  const PlacedArray from(extended_, values.data());
  const PlacedArray to(owned_, owned.data());
  check(VecScatterBegin(scatter_, extended_, owned_, ADD_VALUES, SCATTER_REVERSE));
  check(VecScatterEnd(scatter_, extended_, owned_, ADD_VALUES, SCATTER_REVERSE));
  return owned;
}

FABSEQ_INSTANTIATE_CLASS(ElementHalo);

}  // namespace fabseq
