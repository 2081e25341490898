// SPDX-License-Identifier: MIT
#include "solve/region_elasticity.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Elements with a stiffness in one of the lanes at least.
std::vector<int> elements_with_stiffness(std::span<const double> stiffness, int lanes) {
  std::vector<int> result;
  for (std::size_t begin = 0; begin < stiffness.size(); begin += lanes) {
    const auto of_lanes = stiffness.subspan(begin, lanes);
    if (std::ranges::any_of(of_lanes, [](double value) { return value != 0.0; }))
      result.push_back(static_cast<int>(begin / lanes));
  }
  return result;
}

}  // namespace

template <int Dim>
RegionElasticity<Dim>::RegionElasticity(const Grid<Dim>& grid, const SystemDomain& domain, Make make)
    : grid_(grid), domain_(domain), make_(std::move(make)), whole_(make_(domain)), current_(whole_.get()) {}

template <int Dim>
void RegionElasticity<Dim>::set_operators(int first_layer, int lanes, std::span<const double> stiffness,
                                          bool changed) {
  std::vector<int> elements = elements_with_stiffness(stiffness, lanes);
  if (!any(grid_.comm(), elements.size() < domain_.first_corners.size())) {
    use(*whole_);
    whole_->set_operators(first_layer, lanes, stiffness, changed);
    return;
  }
  Region& region = region_of(first_layer, lanes, std::move(elements));
  use(*region.solver);
  std::vector<double> of_region;
  of_region.reserve(region.elements.size() * lanes);
  for (const int element : region.elements) {
    const auto of_lanes = stiffness.subspan(static_cast<std::size_t>(element) * lanes, lanes);
    of_region.insert(of_region.end(), of_lanes.begin(), of_lanes.end());
  }
  region.solver->set_operators(first_layer, lanes, of_region, changed);
}

/// Blocks that share layers with this one are no more: layers are dealt out anew at times.
template <int Dim>
typename RegionElasticity<Dim>::Region& RegionElasticity<Dim>::region_of(int first_layer, int lanes,
                                                                         std::vector<int> elements) {
  std::erase_if(regions_, [&](const auto& entry) {
    const bool is_apart =
        entry.first + entry.second.lanes <= first_layer || first_layer + lanes <= entry.first;
    if (is_apart || (entry.first == first_layer && entry.second.lanes == lanes)) return false;
    if (current_ == entry.second.solver.get()) current_ = whole_.get();
    return true;
  });
  Region& region = regions_[first_layer];
  if (!any(grid_.comm(), !region.solver || region.elements != elements)) return region;
  if (current_ == region.solver.get()) current_ = whole_.get();
  region.solver.reset();
  region.lanes = lanes;
  region.domain = {domain_.components, {}, domain_.fixed};
  for (const int element : elements) region.domain.first_corners.push_back(domain_.first_corners[element]);
  region.elements = std::move(elements);
  region.solver = make_(region.domain);
  if (tolerance_) region.solver->set_tolerance(*tolerance_);
  return region;
}

/// One solver has memory at a time.
template <int Dim>
void RegionElasticity<Dim>::use(ElasticitySolver<Dim>& solver) {
  if (current_ != &solver) current_->give_back_memory();
  current_ = &solver;
}

template <int Dim>
void RegionElasticity<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  tolerance_ = tolerance;
  whole_->set_tolerance(tolerance);
  for (auto& [layer, region] : regions_) region.solver->set_tolerance(tolerance);
}

template <int Dim>
void RegionElasticity<Dim>::start_cold() {
  whole_->start_cold();
  for (auto& [layer, region] : regions_) region.solver->start_cold();
}

template <int Dim>
void RegionElasticity<Dim>::give_back_memory() {
  whole_->give_back_memory();
  for (auto& [layer, region] : regions_) region.solver->give_back_memory();
}

FABSEQ_INSTANTIATE_CLASS(RegionElasticity);

}  // namespace fabseq
