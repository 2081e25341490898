// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/large_pages.h"
#include "fabseq/base/mpi.h"
#include "fabseq/grid/grid.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/solve/solve_tolerance.h"

#include <algorithm>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// Solvers for parts of a domain: some of its elements, and the nodes that these touch. They are kept, since
/// forward and adjoint solves come back to them, as often does the next design. One has memory at a time.
template <int Dim, class Solver>
class RegionPool {
 public:
  /// Makes a solver for a domain, which outlives it. Collective.
  using Make = std::function<std::unique_ptr<Solver>(const SystemDomain&)>;

  /// Grid and `domain`, that of all elements, must outlive the pool. Collective on the grid's communicator.
  RegionPool(const Grid<Dim>& grid, const SystemDomain& domain, Make make)
      : grid_(grid), domain_(domain), make_(std::move(make)), whole_(make_(domain)), current_(whole_.get()) {}

  Solver& whole() const { return *whole_; }
  Solver& current() const { return *current_; }
  /// Makes the solver for these elements, ascending numbers in the domain, the current one. Collective.
  Solver& choose(std::vector<int> elements);
  /// Values of the elements that the current solver has, `count` for each, of those of the whole domain.
  std::vector<double> picked(std::span<const double> values, int count) const;
  /// Sets the tolerance of all solvers.
  void set_tolerance(const SolveTolerance& tolerance) {
    tolerance_ = tolerance;
    current_->set_tolerance(tolerance);
  }
  void start_cold() {
    whole_->start_cold();
    for (Region& region : regions_) region.solver->start_cold();
  }
  void release_memory() {
    current_->release_memory();
    KeptLargePages::drop();
  }

 private:
  struct Region {
    std::vector<int> elements;
    SystemDomain domain;
    std::unique_ptr<Solver> solver;
  };
  /// Number of eights in a hundred layers, and some.
  static constexpr std::size_t most_regions = 16;
  typename std::list<Region>::iterator find(const std::vector<int>& elements);
  Solver& use(Solver& solver);

  const Grid<Dim>& grid_;
  const SystemDomain& domain_;
  Make make_;
  std::unique_ptr<Solver> whole_;
  std::list<Region> regions_;  ///< the last used first
  Solver* current_;
  std::optional<SolveTolerance> tolerance_;
};

template <int Dim, class Solver>
Solver& RegionPool<Dim, Solver>::choose(std::vector<int> elements) {
  if (!any(grid_.comm(), elements.size() < domain_.first_corners.size())) return use(*whole_);
  const auto found = find(elements);
  if (found != regions_.end()) {
    regions_.splice(regions_.begin(), regions_, found);
  } else {
    if (regions_.size() == most_regions) regions_.pop_back();
    Region& region = regions_.emplace_front();
    region.domain = {domain_.components, {}, domain_.fixed};
    for (const int element : elements) region.domain.first_corners.push_back(domain_.first_corners[element]);
    region.elements = std::move(elements);
    region.solver = make_(region.domain);
  }
  return use(*regions_.front().solver);
}

template <int Dim, class Solver>
Solver& RegionPool<Dim, Solver>::use(Solver& solver) {
  if (&solver != current_) {
    const KeptLargePages kept;
    current_->release_memory();
  }
  if (tolerance_) solver.set_tolerance(*tolerance_);
  current_ = &solver;
  return solver;
}

/// All ranks find the same one, or none.
template <int Dim, class Solver>
typename std::list<typename RegionPool<Dim, Solver>::Region>::iterator RegionPool<Dim, Solver>::find(
    const std::vector<int>& elements) {
  std::vector<int> differs;
  for (const Region& region : regions_) differs.push_back(region.elements == elements ? 0 : 1);
  sum_in_place(grid_.comm(), std::span<int>(differs));
  return std::next(regions_.begin(), std::ranges::find(differs, 0) - differs.begin());
}

template <int Dim, class Solver>
std::vector<double> RegionPool<Dim, Solver>::picked(std::span<const double> values, int count) const {
  if (current_ == whole_.get()) return {values.begin(), values.end()};
  std::vector<double> result;
  result.reserve(regions_.front().elements.size() * count);
  for (const int element : regions_.front().elements) {
    const auto of_element = values.subspan(static_cast<std::size_t>(element) * count, count);
    result.insert(result.end(), of_element.begin(), of_element.end());
  }
  return result;
}

/// Numbers of the elements with a value other than 0 among their `count`.
inline std::vector<int> elements_with_values(std::span<const double> values, int count) {
  std::vector<int> result;
  for (std::size_t begin = 0; begin < values.size(); begin += count)
    if (std::ranges::any_of(values.subspan(begin, count), [](double value) { return value != 0.0; }))
      result.push_back(static_cast<int>(begin / count));
  return result;
}

}  // namespace fabseq
