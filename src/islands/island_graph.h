// SPDX-License-Identifier: MIT
/// \file
/// Stiff islands of a field, found in a graph of its basins (docs/developer/lane-engine.md 11.2).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace fabseq {

/// Turn in which an element rises out of the sinking field: the stiffest first, to a fifth; of these the one
/// with the lowest number in the whole box.
struct RiseOrder {
  std::int64_t depth = std::numeric_limits<std::int64_t>::max();  ///< falls with the stiffness
  std::int64_t element = 0;

  bool operator<(const RiseOrder& other) const {
    return depth != other.depth ? depth < other.depth : element < other.element;
  }
  bool operator<=(const RiseOrder& other) const { return !(other < *this); }
  /// The turn of an element of this stiffness, which is above 0.
  static RiseOrder of(double stiffness, std::int64_t element) { return {depth_of(stiffness), element}; }
  /// Returns the depth by the exponent and two bits of the fraction.
  static std::int64_t depth_of(double stiffness);
  static constexpr std::int64_t depths = std::int64_t{1} << 13;  ///< -depth_of() is below
  /// Returns the turn before all others.
  static constexpr RiseOrder earliest() { return {std::numeric_limits<std::int64_t>::min(), 0}; }
};

/// Elements that follow their stiffest neighbours to the same element, or as many of them as a rank has.
struct Basin {
  static constexpr int smallest = 4;  ///< elements of an island that a saddle ends

  std::int64_t id = 0;    ///< of no other in the graph
  std::int64_t lane = 0;  ///< whose field it is of
  double peak = 0.0;      ///< stiffness of the elements that rise alone: the largest; 0 if there are none
  std::int64_t size = 0;  ///< elements
  RiseOrder supported;    ///< of the first element with a held node; the largest turn if there is none
  std::array<RiseOrder, smallest>
      first{};  ///< of the first elements, ascending; the largest turn if there are fewer

  void add(const RiseOrder& turn, bool is_supported);
  /// Takes another basin in.
  void take_in(const Basin& other);
  /// Whether it has `smallest` elements and none with a held node by then.
  bool may_end(const RiseOrder& now) const { return first.back() <= now && now < supported; }
};

/// Two basins meet when an element rises between them.
struct Saddle {
  enum Kind : std::int64_t {
    core = -2,  ///< both are stiffer than all saddles where an island ends: whenever, RiseOrder::earliest()
    link = -1   ///< the element's basin begins there, as a part of its neighbour's
    // Otherwise the number of the neighbour, 0 to 2 Dim - 1.
  };
  RiseOrder turn;  ///< of the element
  std::int64_t kind = core;
  double stiffness = 0.0;     ///< of the element
  std::int64_t basin = 0;     ///< the element's
  std::int64_t neighbor = 0;  ///< the neighbour's
  std::int64_t lane = 0;      ///< whose field it is of
};

/// What an island is, for one field.
struct IslandLimits {
  /// `least`, `largest`: the least stiffness above 0, and the largest. `peak_over_saddle`: the contrast.
  IslandLimits(double least, double largest, double peak_over_saddle, int most_islands);

  double floor = 0.0;           ///< softer elements do not rise
  double least_peak = 0.0;      ///< an island's peak is above, where it meets nothing
  double contrast = 0.0;        ///< an island's peak over the saddle where it ends is above
  std::int64_t core_depth = 0;  ///< elements of less depth are stiffer than any saddle where an island ends
  int most = 0;                 ///< islands

  bool is_island(const Basin& basin) const {
    return basin.supported.depth == RiseOrder{}.depth && basin.peak > least_peak;
  }
  /// Whether island a is the larger one, or the one whose first element rises earlier.
  static bool precedes(const Basin& a, const Basin& b);
};

/// Islands of a field.
struct BasinIslands {
  int count = 0;
  std::vector<int> of_basin;  ///< in the order of the basins given; -1: none
};

/// Lets the basins meet at the saddles, in the order of their turns. A basin is an island if it holds no
/// supported element and its peak is `contrast` times stiffer than the saddle where it meets another, the
/// lesser of two that meet first; or than the least stiffness, where it meets none. The largest islands
/// count, the one whose first element rises earlier if they are of the same size. `basins`: all basins of the
/// field; `saddles`: at least those by which components of the risen elements become one. Not collective.
BasinIslands find_islands(std::span<const Basin> basins, std::vector<Saddle> saddles,
                          const IslandLimits& limits);

}  // namespace fabseq
