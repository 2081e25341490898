// SPDX-License-Identifier: MIT
#include "fabseq/grid/decomposition.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>

namespace fabseq {

namespace {

/// End of the longest range from `start` on whose sum stays within `bound`. `sums`: running sums of the
/// weights.
int longest_range_end(const std::vector<double>& sums, int start, double bound) {
  return static_cast<int>(std::upper_bound(sums.begin() + start, sums.end(), sums[start] + bound) -
                          sums.begin()) -
         1;
}

/// Whether the entries can be split into `parts` ranges of at least one entry with sums within `bound`.
bool can_be_split(const std::vector<double>& sums, int parts, double bound) {
  const int count = static_cast<int>(sums.size()) - 1;
  int start = 0;
  for (int part = 0; part < parts; ++part) {
    const int end = std::min(longest_range_end(sums, start, bound), count - (parts - 1 - part));
    if (end <= start) return false;
    start = end;
  }
  return start == count;
}

/// Smallest bound, up to rounding, for which can_be_split() holds.
double smallest_bound(const std::vector<double>& sums, int parts) {
  double low = 0.0, high = sums.back();
  for (int step = 0; step < 64 && high - low > 1e-12 * sums.back(); ++step) {
    const double middle = 0.5 * (low + high);
    (can_be_split(sums, parts, middle) ? high : low) = middle;
  }
  return high * (1.0 + 1e-12);
}

/// Smallest possible start of each range: from there to the end, all ranges can stay within `bound` and hold
/// at least one entry each.
std::vector<int> smallest_starts(const std::vector<double>& sums, int parts, double bound) {
  std::vector<int> starts(static_cast<std::size_t>(parts) + 1);
  starts[parts] = static_cast<int>(sums.size()) - 1;
  for (int part = parts - 1; part >= 0; --part) {
    const double least = sums[starts[part + 1]] - bound;
    const int fits = static_cast<int>(std::lower_bound(sums.begin(), sums.end(), least) - sums.begin());
    starts[part] = std::min(std::max(fits, part), starts[part + 1] - 1);
  }
  return starts;
}

/// Slab of a rank if the whole grid is cut across its longest axis into one slab per rank. The slab may be
/// empty.
template <int Dim>
IndexBox<Dim> slab_of(int rank, int ranks, const Index<Dim>& elements) {
  int axis = Dim - 1;
  for (int a = Dim - 2; a >= 0; --a)
    if (elements[a] > elements[axis]) axis = a;
  IndexBox<Dim> slab{Index<Dim>{}, elements};
  const auto cut = [&](int r) {
    return static_cast<int>(static_cast<std::int64_t>(elements[axis]) * r / ranks);
  };
  slab.start[axis] = cut(rank);
  slab.size[axis] = cut(rank + 1) - cut(rank);
  return slab;
}

/// Weights of one slab of the grid on each rank, and sums over the whole grid that follow from them.
/// Construction is collective.
template <int Dim>
class SlabWeights {
 public:
  SlabWeights(MPI_Comm comm, const Index<Dim>& elements, const ElementWeights<Dim>& weights)
      : comm_(comm), slab_(slab_of<Dim>(rank_of(comm), size_of(comm), elements)) {
    // Ranks with empty slabs call it, too: the function may be collective (a parallel read).
    if (weights) weights_ = weights(slab_);
    // Without any weight, all elements count alike.
    alike_ = !(sum(comm, std::accumulate(weights_.begin(), weights_.end(), 0.0)) > 0.0);
    sum_marginals(elements);
  }

  /// Sum of the weights of all elements with each index along an axis.
  const std::vector<double>& marginal(int axis) const { return marginals_[axis]; }

  /// Weight of the heaviest rank. Collective.
  double heaviest_rank(const Decomposition<Dim>& decomposition) const {
    if (alike_) return largest_box(decomposition);
    std::array<std::vector<int>, Dim> process_of;  // [axis][index]
    for (int axis = 0; axis < Dim; ++axis) {
      const std::vector<int>& starts = decomposition.range_starts[axis];
      for (int process = 0; process + 1 < static_cast<int>(starts.size()); ++process)
        process_of[axis].insert(process_of[axis].end(),
                                static_cast<std::size_t>(starts[process + 1] - starts[process]), process);
    }
    std::vector<double> load(
        static_cast<std::size_t>(IndexBox<Dim>{Index<Dim>{}, decomposition.processes}.count()));
    slab_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      Index<Dim> position;
      for (int axis = 0; axis < Dim; ++axis) position[axis] = process_of[axis][element[axis]];
      load[decomposition.rank_at(position)] += weights_[offset];
    });
    sum_in_place(comm_, load);
    return *std::max_element(load.begin(), load.end());
  }

 private:
  static double largest_box(const Decomposition<Dim>& decomposition) {
    double result = 1.0;
    for (const std::vector<int>& starts : decomposition.range_starts) {
      int longest = 0;
      for (std::size_t i = 1; i < starts.size(); ++i) longest = std::max(longest, starts[i] - starts[i - 1]);
      result *= longest;
    }
    return result;
  }

  void sum_marginals(const Index<Dim>& elements) {
    const auto all = static_cast<double>(IndexBox<Dim>{Index<Dim>{}, elements}.count());
    for (int axis = 0; axis < Dim; ++axis)
      marginals_[axis].assign(static_cast<std::size_t>(elements[axis]), alike_ ? all / elements[axis] : 0.0);
    if (alike_) return;
    slab_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      for (int axis = 0; axis < Dim; ++axis) marginals_[axis][element[axis]] += weights_[offset];
    });
    for (std::vector<double>& marginal : marginals_) sum_in_place(comm_, marginal);
  }

  MPI_Comm comm_;
  IndexBox<Dim> slab_;
  std::vector<double> weights_;
  bool alike_ = false;
  std::array<std::vector<double>, Dim> marginals_;
};

/// Number of element faces between ranks, which halo exchanges cost.
template <int Dim>
double surface_between(const Index<Dim>& processes, const Index<Dim>& elements) {
  double surface = 0.0;
  for (int axis = 0; axis < Dim; ++axis) {
    double cut = processes[axis] - 1;
    for (int other = 0; other < Dim; ++other)
      if (other != axis) cut *= elements[other];
    surface += cut;
  }
  return surface;
}

/// split_evenly() at multiples of 4 or 2 if there are enough elements. Ranks that begin at an element of a
/// coarse grid also share the work of that multigrid level (docs/formulation.md 11.2).
std::vector<int> split_on_coarse_grids(const std::vector<double>& weights, int parts) {
  const int count = static_cast<int>(weights.size());
  const int block = count >= 16 * parts ? 4 : count >= 6 * parts ? 2 : 1;
  std::vector<double> blocks(static_cast<std::size_t>((count + block - 1) / block), 0.0);
  for (int i = 0; i < count; ++i) blocks[i / block] += weights[i];
  std::vector<int> starts = split_evenly(blocks, parts);
  for (int& start : starts) start = std::min(count, start * block);
  return starts;
}

template <int Dim>
Decomposition<Dim> balanced(const SlabWeights<Dim>& weights, const Index<Dim>& processes) {
  Decomposition<Dim> result;
  result.processes = processes;
  for (int axis = 0; axis < Dim; ++axis)
    result.range_starts[axis] = split_on_coarse_grids(weights.marginal(axis), processes[axis]);
  return result;
}

/// Gives all ranks the choice of rank 0: sums may differ in the last digit between ranks, choices must not.
template <int Dim>
void agree(MPI_Comm comm, Decomposition<Dim>& decomposition) {
  MPI_Bcast(decomposition.processes.data(), Dim, MPI_INT, 0, comm);
  for (int axis = 0; axis < Dim; ++axis) {
    decomposition.range_starts[axis].resize(static_cast<std::size_t>(decomposition.processes[axis]) + 1);
    MPI_Bcast(decomposition.range_starts[axis].data(), decomposition.processes[axis] + 1, MPI_INT, 0, comm);
  }
}

}  // namespace

template <int Dim>
IndexBox<Dim> Decomposition<Dim>::elements_of(const Index<Dim>& position) const {
  IndexBox<Dim> box;
  for (int axis = 0; axis < Dim; ++axis) {
    box.start[axis] = range_starts[axis][position[axis]];
    box.size[axis] = range_starts[axis][position[axis] + 1] - box.start[axis];
  }
  return box;
}

template <int Dim>
Index<Dim> Decomposition<Dim>::position_of_element(const Index<Dim>& element) const {
  Index<Dim> position;
  for (int axis = 0; axis < Dim; ++axis) {
    const std::vector<int>& starts = range_starts[axis];
    position[axis] =
        static_cast<int>(std::upper_bound(starts.begin(), starts.end(), element[axis]) - starts.begin()) - 1;
  }
  return position;
}

std::vector<int> split_evenly(const std::vector<double>& weights, int parts) {
  std::vector<double> sums(weights.size() + 1, 0.0);
  std::partial_sum(weights.begin(), weights.end(), sums.begin() + 1);
  const int count = static_cast<int>(weights.size());
  const double bound = smallest_bound(sums, parts);
  const std::vector<int> smallest = smallest_starts(sums, parts, bound);

  std::vector<int> starts(static_cast<std::size_t>(parts) + 1, 0);
  for (int part = 1; part < parts; ++part) {
    const int low = std::max(smallest[part], starts[part - 1] + 1);
    const int high =
        std::max(low, std::min(longest_range_end(sums, starts[part - 1], bound), count - (parts - part)));
    const double ideal = sums.back() * part / parts;
    starts[part] = low;
    for (int end = low + 1; end <= high; ++end)
      if (std::abs(sums[end] - ideal) < std::abs(sums[starts[part]] - ideal)) starts[part] = end;
  }
  starts[parts] = count;
  return starts;
}

template <int Dim>
std::vector<Index<Dim>> fitting_process_grids(int ranks, const Index<Dim>& elements) {
  std::vector<Index<Dim>> grids;
  const auto extend = [&](const auto& self, Index<Dim> grid, int axis, int left) -> void {
    if (axis == 0) {
      grid[0] = left;
      if (left <= elements[0]) grids.push_back(grid);
      return;
    }
    for (int factor = 1; factor <= std::min(left, elements[axis]); ++factor) {
      if (left % factor != 0) continue;
      grid[axis] = factor;
      self(self, grid, axis - 1, left / factor);
    }
  };
  extend(extend, Index<Dim>{}, Dim - 1, ranks);
  return grids;
}

template <int Dim>
Decomposition<Dim> choose_decomposition(MPI_Comm comm, const Index<Dim>& elements,
                                        const ElementWeights<Dim>& weights) {
  return choose_decomposition<Dim>(comm, size_of(comm), elements, weights);
}

template <int Dim>
Decomposition<Dim> choose_decomposition(MPI_Comm comm, int ranks, const Index<Dim>& elements,
                                        const ElementWeights<Dim>& weights) {
  const std::vector<Index<Dim>> grids = fitting_process_grids<Dim>(ranks, elements);
  if (grids.empty())
    throw InputError(
        "/domain/elements: " + to_text<Dim>(elements) + " cannot be dealt out to " + std::to_string(ranks) +
        " ranks in a grid of ranks with at most one rank an element along each axis: use fewer ranks or more "
        "layer groups");
  if (ranks == 1) {
    Decomposition<Dim> whole{grids.front(), {}};
    for (int axis = 0; axis < Dim; ++axis) whole.range_starts[axis] = {0, elements[axis]};
    return whole;
  }

  const SlabWeights<Dim> slab(comm, elements, weights);
  std::vector<double> heaviest;
  for (const Index<Dim>& grid : grids) heaviest.push_back(slab.heaviest_rank(balanced<Dim>(slab, grid)));
  const double lightest = *std::min_element(heaviest.begin(), heaviest.end());
  constexpr double tie = 1.01;
  int best = -1;
  for (int i = 0; i < static_cast<int>(grids.size()); ++i) {
    if (heaviest[i] > tie * lightest) continue;
    if (best < 0 || surface_between<Dim>(grids[i], elements) < surface_between<Dim>(grids[best], elements))
      best = i;
  }
  Decomposition<Dim> result = balanced<Dim>(slab, grids[best]);
  agree<Dim>(comm, result);
  return result;
}

FABSEQ_INSTANTIATE_STRUCT(Decomposition);
FABSEQ_INSTANTIATE_FUNCTION(fitting_process_grids);
template Decomposition<2> choose_decomposition<2>(MPI_Comm, const Index<2>&, const ElementWeights<2>&);
template Decomposition<3> choose_decomposition<3>(MPI_Comm, const Index<3>&, const ElementWeights<3>&);
template Decomposition<3> choose_decomposition<3>(MPI_Comm, int, const Index<3>&, const ElementWeights<3>&);

}  // namespace fabseq
