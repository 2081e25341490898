// SPDX-License-Identifier: MIT
#include "fabseq/grid/components.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/box_gather.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace fabseq {

namespace {

/// Steps from an element to those that it is connected with.
template <int Dim>
std::vector<Index<Dim>> steps_of(Contact contact) {
  std::vector<Index<Dim>> result;
  ringed<Dim>({{}, uniform_index<Dim>(1)}).for_each([&](const Index<Dim>& step, std::int64_t) {
    int moved = 0;
    for (const int entry : step) moved += std::abs(entry);
    if (moved == 1 || (moved > 1 && contact == Contact::corner)) result.push_back(step);
  });
  return result;
}

/// Calls f(neighbour) for the elements of `box` that are connected with `element`.
template <int Dim, class Function>
void for_each_neighbor(const IndexBox<Dim>& box, const std::vector<Index<Dim>>& steps,
                       const Index<Dim>& element, Function&& f) {
  for (const Index<Dim>& step : steps) {
    Index<Dim> neighbor = element;
    for (int axis = 0; axis < Dim; ++axis) neighbor[axis] += step[axis];
    if (box.contains(neighbor)) f(neighbor);
  }
}

/// Components of this rank's elements alone, numbered in the order of their lowest elements.
struct LocalComponents {
  std::vector<int> of_element;      ///< component of each owned element, -1 if it is not marked
  std::vector<std::int64_t> first;  ///< number, in the whole grid, of each component's lowest element
};

template <int Dim>
LocalComponents flood_fill(const Grid<Dim>& grid, std::span<const double> marks,
                           const std::vector<Index<Dim>>& steps) {
  const IndexBox<Dim>& box = grid.owned_elements();
  const IndexBox<Dim> all = grid.all_elements();
  LocalComponents components;
  components.of_element.assign(marks.size(), -1);
  std::vector<std::int64_t> pending;
  int component = 0;
  const auto visit = [&](const Index<Dim>& element) {
    const std::int64_t offset = box.offset(element);
    if (!(marks[offset] > 0.0) || components.of_element[offset] >= 0) return;
    components.of_element[offset] = component;
    pending.push_back(offset);
  };
  box.for_each([&](const Index<Dim>& seed, std::int64_t) {
    visit(seed);
    if (pending.empty()) return;
    components.first.push_back(all.offset(seed));
    while (!pending.empty()) {
      const Index<Dim> element = box.index(pending.back());
      pending.pop_back();
      for_each_neighbor<Dim>(box, steps, element, visit);
    }
    ++component;
  });
  return components;
}

/// A contact between a local component and an element of another rank.
struct OuterContact {
  int component;
  std::int64_t neighbor;  ///< offset in the box with the elements around this rank's
};

template <int Dim>
std::vector<OuterContact> contacts_of(const IndexBox<Dim>& box, const LocalComponents& components,
                                      const std::vector<Index<Dim>>& steps) {
  const IndexBox<Dim> ring = ringed(box);
  std::vector<OuterContact> contacts;
  box.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    if (components.of_element[offset] < 0) return;
    for_each_neighbor<Dim>(ring, steps, element, [&](const Index<Dim>& neighbor) {
      if (!box.contains(neighbor)) contacts.push_back({components.of_element[offset], ring.offset(neighbor)});
    });
  });
  return contacts;
}

/// Label of each local component: the lowest element of its component over all ranks, as a lexicographic
/// number in the whole grid. Each round carries labels across one boundary between ranks, so the number of
/// rounds is that of the boundaries that a component winds through. Collective.
template <int Dim>
std::vector<std::int64_t> join_components(const Grid<Dim>& grid, const LocalComponents& components,
                                          const std::vector<Index<Dim>>& steps) {
  constexpr std::int64_t nothing = -1;
  const IndexBox<Dim>& box = grid.owned_elements();
  const BoxGather<Dim> around(grid.comm(), box, ringed(box));
  const std::vector<OuterContact> contacts = contacts_of<Dim>(box, components, steps);
  std::vector<std::int64_t> labels = components.first;
  bool changed = true;
  while (any(grid.comm(), changed)) {
    changed = false;
    const auto label_at = [&](const Index<Dim>& element) {
      const int component = components.of_element[box.offset(element)];
      return component < 0 ? nothing : labels[component];
    };
    const auto extended = around.template gather<std::int64_t>(label_at, nothing);
    for (const OuterContact& contact : contacts) {
      const std::int64_t label = extended[contact.neighbor];
      if (label < 0 || label >= labels[contact.component]) continue;
      labels[contact.component] = label;
      changed = true;
    }
  }
  return labels;
}

/// Labels of all components, ascending, on all ranks. The rank that owns the element a label names
/// contributes the label.
std::vector<std::int64_t> gather_labels(MPI_Comm comm, const std::vector<std::int64_t>& first,
                                        const std::vector<std::int64_t>& labels) {
  std::vector<std::int64_t> own;
  for (std::size_t c = 0; c < first.size(); ++c)
    if (first[c] == labels[c]) own.push_back(first[c]);
  std::vector<std::int64_t> all = gather_all(comm, own);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

template <int Dim>
Components find_components(const Grid<Dim>& grid, std::span<const double> marks, Contact contact) {
  const std::vector<Index<Dim>> steps = steps_of<Dim>(contact);
  LocalComponents local = flood_fill<Dim>(grid, marks, steps);
  const std::vector<std::int64_t> labels = join_components<Dim>(grid, local, steps);
  const std::vector<std::int64_t> all = gather_labels(grid.comm(), local.first, labels);
  for (int& component : local.of_element)
    if (component >= 0)
      component = static_cast<int>(std::lower_bound(all.begin(), all.end(), labels[component]) - all.begin());
  return {static_cast<int>(all.size()), std::move(local.of_element)};
}

FABSEQ_INSTANTIATE_FUNCTION(find_components);

}  // namespace fabseq
