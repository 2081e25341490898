// SPDX-License-Identifier: MIT
#include "fabseq/grid/carried_field.h"

#include "fabseq/grid/box_gather.h"

namespace fabseq {

template <int Dim>
std::vector<double> carried_field(MPI_Comm comm, const IndexBox<Dim>& owned, std::span<const double> field,
                                  int components, const IndexBox<Dim>& wanted, int factor) {
  const IndexBox<Dim> parents = wanted.coarsened(uniform_index<Dim>(factor));
  const BoxGather<Dim> to_wanted(comm, owned, parents);
  std::vector<double> result(static_cast<std::size_t>(wanted.count()) * components);
  for (int component = 0; component < components; ++component) {
    const auto values = to_wanted.template gather<double>(
        [&](const Index<Dim>& index) { return field[owned.offset(index) * components + component]; });
    wanted.for_each([&](const Index<Dim>& index, std::int64_t offset) {
      Index<Dim> parent = index;
      for (int& i : parent) i /= factor;
      result[offset * components + component] = values[parents.offset(parent)];
    });
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(carried_field);

}  // namespace fabseq
