// SPDX-License-Identifier: MIT
#include "fabseq/grid/grid.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

namespace fabseq {

namespace {

/// Used in assertions only.
[[maybe_unused]] PetscInt local_size(Vec vector) {
  PetscInt size = 0;
  check(VecGetLocalSize(vector, &size));
  return size;
}

/// Number of nodes along the first `axes` axes, in floating point, which cannot overflow: with up to 2^31
/// elements per axis it can exceed 64 bits.
template <int Dim>
double node_count(const Index<Dim>& elements, int axes = Dim) {
  double count = 1.0;
  for (int axis = 0; axis < axes; ++axis) count *= elements[axis] + 1.0;
  return count;
}

/// "12345", of a number too large for an integer, too.
std::string whole_number(double value) { return formatted("%.0f", value); }

/// Throws InputError if PETSc's indices cannot count the values of a nodal field; the same on all ranks.
template <int Dim>
void require_countable(const Index<Dim>& elements, int components) {
  const double values = components * node_count<Dim>(elements);
  constexpr auto most = std::numeric_limits<PetscInt>::max();
  if (values <= static_cast<double>(most)) return;
  throw InputError("/domain/elements: " + to_text<Dim>(elements) + " with " + std::to_string(components) +
                   (components == 1 ? " value" : " values") + " a node make " + whole_number(values) +
                   " values, at most " + std::to_string(most) + " are allowed (PETSc's indices)" +
                   (sizeof(PetscInt) == 4 ? ": build with FABSEQ_64_BIT_INDICES" : ""));
}

/// Elements along an axis: indices that are twice as large, of a grid twice as fine, are still an int.
constexpr int most_along_axis = 1'000'000'000;

/// Lower bound of the memory that grid and part take per node (measured: 240).
constexpr double bytes_per_node = 150.0;

template <int Dim>
void require_domain(MPI_Comm comm, const Domain<Dim>& domain) {
  for (int axis = 0; axis < Dim; ++axis) {
    if (domain.elements[axis] < 1)
      throw InputError("/domain/elements: " + to_text<Dim>(domain.elements) +
                       ", needs at least 1 along each axis");
    if (domain.elements[axis] > most_along_axis)
      throw InputError("/domain/elements: " + to_text<Dim>(domain.elements) + ", at most " +
                       std::to_string(most_along_axis) + " are allowed along an axis");
    if (!(domain.size[axis] > 0.0))
      throw InputError("/domain/size: " + formatted("%f", domain.size[axis]) + " along axis " +
                       std::to_string(axis) + ", needs positive lengths");
  }
  constexpr int most_in_plane = std::numeric_limits<int>::max();
  if (const double plane = node_count<Dim>(domain.elements, Dim - 1); plane > most_in_plane)
    throw InputError("/domain/elements: " + to_text<Dim>(domain.elements) + " make " + whole_number(plane) +
                     " nodes across the last axis, at most " + std::to_string(most_in_plane) +
                     " are allowed (fields are written plane by plane)");
  require_countable<Dim>(domain.elements, Dim);  // the components of the displacement
  require_memory(comm, bytes_per_node * node_count<Dim>(domain.elements),
                 "/domain/elements: " + to_text<Dim>(domain.elements));
}

/// A DMDA with a box stencil of width 1.
template <int Dim>
DmHandle make_node_dm(MPI_Comm comm, const Decomposition<Dim>& nodes, int components) {
  std::array<std::vector<PetscInt>, Dim> counts;  // [axis][process]
  for (int axis = 0; axis < Dim; ++axis) {
    const std::vector<int>& starts = nodes.range_starts[axis];
    for (std::size_t process = 0; process + 1 < starts.size(); ++process)
      counts[axis].push_back(starts[process + 1] - starts[process]);
  }
  const auto all = [&](int axis) { return nodes.range_starts[axis].back(); };
  const Index<Dim>& processes = nodes.processes;
  constexpr DMBoundaryType open = DM_BOUNDARY_NONE;
  DmHandle dm;
  if constexpr (Dim == 2)
    check(DMDACreate2d(comm, open, open, DMDA_STENCIL_BOX, all(0), all(1), processes[0], processes[1],
                       components, 1, counts[0].data(), counts[1].data(), dm.receive()));
  else
    check(DMDACreate3d(comm, open, open, open, DMDA_STENCIL_BOX, all(0), all(1), all(2), processes[0],
                       processes[1], processes[2], components, 1, counts[0].data(), counts[1].data(),
                       counts[2].data(), dm.receive()));
  check(DMSetUp(dm));
  return dm;
}

}  // namespace

template <int Dim>
NodeExchange<Dim>::NodeExchange(MPI_Comm comm, const Decomposition<Dim>& nodes, int components)
    : dm_(make_node_dm(comm, nodes, components)) {
  std::array<PetscInt, 3> owned{}, ghosted{};
  check(DMDAGetCorners(dm_, nullptr, nullptr, nullptr, &owned[0], &owned[1], &owned[2]));
  check(DMDAGetGhostCorners(dm_, nullptr, nullptr, nullptr, &ghosted[0], &ghosted[1], &ghosted[2]));
  const auto values = [components](const std::array<PetscInt, 3>& size) {
    return components * size[0] * size[1] * size[2];
  };
  // The vectors have no arrays of their own; they are lent those of the caller.
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
std::vector<double> NodeExchange<Dim>::ghosted(std::span<const double> owned) const {
  std::vector<double> result(static_cast<std::size_t>(local_size(ghosted_)));
  to_ghosted(owned, result);
  return result;
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

template <int Dim>
Grid<Dim>::Grid(MPI_Comm comm, const Domain<Dim>& domain, const ElementWeights<Dim>& weights)
    : comm_(comm), domain_(domain) {
  require_domain<Dim>(comm, domain);
  for (int axis = 0; axis < Dim; ++axis) spacing_[axis] = domain.size[axis] / domain.elements[axis];
  decomposition_ = choose_decomposition<Dim>(comm, size_of(comm), domain.elements, weights);
  const Index<Dim> position = decomposition_.position_of(rank_of(comm));
  owned_elements_ = decomposition_.elements_of(position);
  owned_nodes_ = decomposition_.of_nodes().elements_of(position);
  ghosted_nodes_ = ringed(owned_nodes_).common_with(all_nodes());
  if (any(comm, ghosted_nodes_.count() > std::numeric_limits<int>::max()))
    throw InputError("/domain/elements: " + to_text<Dim>(domain.elements) + " on " +
                     std::to_string(size_of(comm)) + " ranks leave a rank more than " +
                     std::to_string(std::numeric_limits<int>::max()) + " nodes: use more ranks");

  for (int corner = 0; corner < corner_count<Dim>; ++corner)
    corner_offsets_[corner] = first_corner(stepped<Dim>(ghosted_nodes_.start, corner, 1));

  element_starts_.push_back(0);
  for (int rank = 0; rank < size_of(comm); ++rank)
    element_starts_.push_back(element_starts_[rank] +
                              decomposition_.elements_of(decomposition_.position_of(rank)).count());
}

template <int Dim>
double Grid<Dim>::element_volume() const {
  double volume = Dim == 2 ? domain_.thickness : 1.0;
  for (const double edge : spacing_) volume *= edge;
  return volume;
}

template <int Dim>
IndexBox<Dim> Grid<Dim>::all_nodes() const {
  IndexBox<Dim> nodes = all_elements();
  for (int& size : nodes.size) ++size;
  return nodes;
}

template <int Dim>
std::int64_t Grid<Dim>::element_number(const Index<Dim>& element) const {
  const Index<Dim> process = decomposition_.position_of_element(element);
  return element_starts_[decomposition_.rank_at(process)] +
         decomposition_.elements_of(process).offset(element);
}

template <int Dim>
const NodeExchange<Dim>& Grid<Dim>::exchange(int components) const {
  std::unique_ptr<NodeExchange<Dim>>& entry = exchanges_[components];
  if (entry) return *entry;
  require_countable<Dim>(domain_.elements, components);
  entry = std::make_unique<NodeExchange<Dim>>(comm_, decomposition_.of_nodes(), components);
  return *entry;
}

FABSEQ_INSTANTIATE_CLASS(Grid);
FABSEQ_INSTANTIATE_CLASS(NodeExchange);

}  // namespace fabseq
