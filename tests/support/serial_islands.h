// SPDX-License-Identifier: MIT
/// \file
/// Stiff islands by letting the whole field sink, element by element: what IslandMap is compared with.
#pragma once

#include "fabseq/grid/index_box.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace fabseq::test {

/// Islands of a field, and which of them each node of the box is on, lexicographic; -1: none.
struct SerialIslands {
  int count = 0;
  std::vector<int> node_island;
};

/// Sets that can be joined; each has a representative.
class SunkSets {
 public:
  void resize(std::size_t count) { parent_.assign(count, -1); }
  bool contains(int member) const { return parent_[member] >= 0; }
  void add(int member) { parent_[member] = member; }
  int append() {
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  int find(int member) {
    while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
    return member;
  }
  void join(int member, int into) { parent_[find(member)] = find(into); }

 private:
  std::vector<int> parent_;
};

/// Elements stiffer than `floor`, stiffest first to a fifth: by the exponent and two bits of the fraction.
inline std::vector<int> order_by_stiffness(std::span<const double> stiffness, double floor) {
  constexpr int shift = 50;
  const auto key = [&](std::size_t e) { return std::bit_cast<std::uint64_t>(stiffness[e]) >> shift; };
  std::vector<int> starts((std::size_t{1} << (63 - shift)) + 1, 0);
  for (std::size_t e = 0; e < stiffness.size(); ++e)
    if (stiffness[e] >= floor) ++starts[key(e)];
  int next = 0;
  for (std::size_t k = starts.size(); k-- > 0;) next += std::exchange(starts[k], next);
  std::vector<int> order(static_cast<std::size_t>(next));
  for (std::size_t e = 0; e < stiffness.size(); ++e)
    if (stiffness[e] >= floor) order[starts[key(e)]++] = static_cast<int>(e);
  return order;
}

/// The sinking of one field.
template <int Dim>
class Watershed {
 public:
  Watershed(const Index<Dim>& elements, std::span<const double> stiffness, std::span<const char> supported,
            double contrast)
      : box_{Index<Dim>{}, elements}, stiffness_(stiffness), supported_(supported), contrast_(contrast) {
    double least = std::numeric_limits<double>::max();
    for (const double value : stiffness)
      if (value > 0.0) least = std::min(least, value);
    const double floor = 3.0 * least;
    components_.resize(stiffness.size());
    basin_of_.assign(stiffness.size(), -1);
    main_basin_.assign(stiffness.size(), -1);
    const std::vector<int> order = order_by_stiffness(stiffness, floor);
    for (const int element : order) rise(element);
    for (const int element : order) {
      const int basin = basins_.find(main_basin_[components_.find(element)]);
      if (!properties_[basin].supported && properties_[basin].peak > contrast * least)
        properties_[basin].island = true;
    }
  }

  /// Islands, largest first; of equal size, the one whose first element rose earlier.
  std::vector<int> islands() const {
    std::vector<int> result;
    for (std::size_t basin = 0; basin < properties_.size(); ++basin)
      if (properties_[basin].island) result.push_back(static_cast<int>(basin));
    std::stable_sort(result.begin(), result.end(), [&](int a, int b) {
      return properties_[a].size != properties_[b].size ? properties_[a].size > properties_[b].size
                                                        : properties_[a].first < properties_[b].first;
    });
    return result;
  }
  /// Basin of an element, -1 for those too soft to be in one.
  int basin(std::int64_t element) { return basin_of_[element] < 0 ? -1 : basins_.find(basin_of_[element]); }

 private:
  struct Properties {
    double peak = 0.0;
    std::int64_t size = 0;
    bool supported = false;
    bool island = false;
    int first = 0;  // basin that it began with: they are numbered as they rise
  };
  static constexpr int smallest = 4;  // elements

  /// Calls `visit` for the face-adjacent elements that have risen already.
  template <class Visit>
  void for_neighbors(int element, Visit&& visit) const {
    const Index<Dim> index = box_.index(element);
    int stride = 1;
    for (int axis = 0; axis < Dim; stride *= box_.size[axis++]) {
      if (index[axis] > 0 && components_.contains(element - stride)) visit(element - stride);
      if (index[axis] + 1 < box_.size[axis] && components_.contains(element + stride))
        visit(element + stride);
    }
  }

  void rise(int element) {
    int stiffest = -1;
    for_neighbors(element, [&](int neighbor) {
      if (stiffest < 0 || stiffness_[neighbor] > stiffness_[stiffest]) stiffest = neighbor;
    });
    components_.add(element);
    if (stiffest < 0) {
      basin_of_[element] = basins_.append();
      properties_.push_back({stiffness_[element], 0, false, false, basin_of_[element]});
      main_basin_[element] = basin_of_[element];
    } else {
      basin_of_[element] = basins_.find(basin_of_[stiffest]);
      main_basin_[element] = main_basin_[components_.find(stiffest)];
      components_.join(element, stiffest);
    }
    Properties& basin = properties_[basins_.find(basin_of_[element])];
    ++basin.size;
    basin.supported = basin.supported || supported_[element] != 0;
    for_neighbors(element, [&](int neighbor) { meet(element, neighbor); });
  }

  /// Two components meet at `element`, their saddle: the lesser basin ends there as an island or is taken in.
  void meet(int element, int neighbor) {
    const int first = components_.find(element), second = components_.find(neighbor);
    if (first == second) return;
    int greater = basins_.find(main_basin_[first]), lesser = basins_.find(main_basin_[second]);
    if (greater != lesser) {
      const bool swap = properties_[greater].supported != properties_[lesser].supported
                            ? properties_[lesser].supported
                            : properties_[lesser].peak > properties_[greater].peak;
      if (swap) std::swap(greater, lesser);
      Properties& ends = properties_[lesser];
      if (!ends.supported && ends.peak > contrast_ * stiffness_[element] && ends.size >= smallest) {
        ends.island = true;
      } else {
        basins_.join(lesser, greater);
        Properties& whole = properties_[greater];
        whole.size += ends.size;
        whole.supported = whole.supported || ends.supported;
        whole.peak = std::max(whole.peak, ends.peak);
        whole.first = std::min(whole.first, ends.first);
      }
    }
    components_.join(second, first);
    main_basin_[components_.find(first)] = greater;
  }

  IndexBox<Dim> box_;
  std::span<const double> stiffness_;
  std::span<const char> supported_;
  double contrast_;
  SunkSets components_, basins_;
  std::vector<int> basin_of_;    ///< of each element
  std::vector<int> main_basin_;  ///< of each component, at its representative
  std::vector<Properties> properties_;
};

/// `stiffness`: of each element of the box, lexicographic, 0 where there is none. `supported`: whether an
/// element has a held node.
template <int Dim>
SerialIslands find_serial_islands(const Index<Dim>& elements, std::span<const double> stiffness,
                                  std::span<const char> supported, double contrast = 100.0, int most = 8) {
  Watershed<Dim> watershed(elements, stiffness, supported, contrast);
  SerialIslands result;
  const std::vector<int> islands = watershed.islands();
  result.count = std::min<int>(most, static_cast<int>(islands.size()));
  if (result.count == 0) return result;
  IndexBox<Dim> nodes{Index<Dim>{}, elements};
  for (int& extent : nodes.size) ++extent;
  result.node_island.assign(static_cast<std::size_t>(nodes.count()), -1);
  std::vector<double> stiffest(result.node_island.size(), 0.0);
  IndexBox<Dim>{Index<Dim>{}, elements}.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    const int basin = watershed.basin(offset);
    const auto place = std::find(islands.begin(), islands.begin() + result.count, basin);
    const int island =
        place == islands.begin() + result.count ? -1 : static_cast<int>(place - islands.begin());
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      Index<Dim> node = element;
      for (int axis = 0; axis < Dim; ++axis) node[axis] += (corner >> axis) & 1;
      const std::int64_t at = nodes.offset(node);
      if (!(stiffness[offset] > stiffest[at])) continue;  // so, what is no number counts as nothing
      stiffest[at] = stiffness[offset];
      result.node_island[at] = island;
    }
  });
  return result;
}

}  // namespace fabseq::test
