// SPDX-License-Identifier: MIT
#include "fabseq/grid/decomposition.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>

namespace fabseq {

namespace {

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

/// split_evenly() at multiples of `block`.
std::vector<int> split_in_blocks(const std::vector<double>& weights, int parts, int block) {
  const int count = static_cast<int>(weights.size());
  std::vector<double> blocks(static_cast<std::size_t>((count + block - 1) / block), 0.0);
  for (int i = 0; i < count; ++i) blocks[i / block] += weights[i];
  std::vector<int> starts = split_evenly(blocks, parts);
  for (int& start : starts) start = std::min(count, start * block);
  return starts;
}

double heaviest_range(const std::vector<double>& weights, const std::vector<int>& starts) {
  double heaviest = 0.0;
  for (std::size_t i = 1; i < starts.size(); ++i)
    heaviest = std::max(heaviest,
                        std::accumulate(weights.begin() + starts[i - 1], weights.begin() + starts[i], 0.0));
  return heaviest;
}

/// split_evenly() at multiples of 4 or 2 if there are enough elements, and of up to `most`, a power of two,
/// if that makes the heaviest range no more than 2 % heavier. Ranks that begin at an element of a coarse grid
/// hold what their elements lie in there, and need send nothing to get to that grid
/// (docs/developer/lane-engine.md 11.2).
std::vector<int> split_on_coarse_grids(const std::vector<double>& weights, int parts, int most) {
  constexpr double worth = 1.02;
  const int count = static_cast<int>(weights.size());
  int block = count >= 16 * parts ? 4 : count >= 6 * parts ? 2 : 1;
  std::vector<int> starts = split_in_blocks(weights, parts, block);
  const double bound = worth * heaviest_range(weights, starts);
  for (block *= 2; block <= most && count >= block * parts; block *= 2) {
    std::vector<int> coarser = split_in_blocks(weights, parts, block);
    if (heaviest_range(weights, coarser) <= bound) starts = std::move(coarser);
  }
  return starts;
}

/// Edge, in elements, of the largest blocks of which all ranks have enough; at least 4.
template <int Dim>
int largest_block(const std::vector<double>& weights, const Index<Dim>& processes) {
  double share = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (const int count : processes) share /= count;
  int block = 4;
  while (share >= static_cast<double>(least_blocks) * std::pow(2 * block, Dim)) block *= 2;
  return block;
}

template <int Dim>
Decomposition<Dim> balanced(const SlabWeights<Dim>& weights, const Index<Dim>& processes) {
  Decomposition<Dim> result;
  result.processes = processes;
  const int most = largest_block<Dim>(weights.marginal(0), processes);
  for (int axis = 0; axis < Dim; ++axis)
    result.range_starts[axis] = split_on_coarse_grids(weights.marginal(axis), processes[axis], most);
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

template <int Dim>
Decomposition<Dim> Decomposition<Dim>::of_nodes() const {
  Decomposition result = *this;
  for (std::vector<int>& starts : result.range_starts) ++starts.back();
  return result;
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
FABSEQ_INSTANTIATE_FUNCTION(choose_decomposition);

}  // namespace fabseq
