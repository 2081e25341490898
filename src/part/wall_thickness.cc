// SPDX-License-Identifier: MIT
#include "fabseq/part/wall_thickness.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fabseq {

namespace {

/// Elements this deep below the surface are in thick walls: with as many on either side.
constexpr int deep = 3;
/// Elements in a tip of this length and of so many elements more as it is deep are not looked at.
constexpr int tip = 2;
/// Elements around a rank's own: those that can be near, and those that decide how deep they lie.
constexpr int halo_width = 6;

/// All steps to the elements around one, over faces, edges and corners; the second half is the first one
/// reversed.
template <int Dim>
std::vector<Index<Dim>> steps_around() {
  std::vector<Index<Dim>> steps;
  ringed(IndexBox<Dim>{{}, uniform_index<Dim>(1)}).for_each([&](const Index<Dim>& step, std::int64_t) {
    if (step != Index<Dim>{}) steps.push_back(step);
  });
  return steps;
}

template <int Dim>
Index<Dim> moved(const Index<Dim>& from, const Index<Dim>& step, int times) {
  Index<Dim> result = from;
  for (int axis = 0; axis < Dim; ++axis) result[axis] += times * step[axis];
  return result;
}

/// How deep elements of part and substrate lie below the surface, on a rank's elements and those around them.
template <int Dim>
class Depths {
 public:
  explicit Depths(const Part<Dim>& part) : halo_(part.grid(), halo_width), spacing_(part.grid().spacing()) {
    const std::vector<double> solid = halo_.gather(part.solid());
    depth_.assign(solid.begin(), solid.end());
    for (int level = 2; level <= deep; ++level) {
      const std::vector<char> before = depth_;
      halo_.box().for_each([&](const Index<Dim>& element, std::int64_t offset) {
        if (before[offset] == level - 1 && least_around(element, before) == level - 1)
          depth_[offset] = static_cast<char>(level);
      });
    }
  }

  /// Whether the element lies in a thin wall, and none near it lies deeper: not at the surface of what is
  /// thick, nor in the tip of a wedge.
  bool is_middle_of_thin_wall(const Index<Dim>& element) const {
    const int here = depth(element), reach = here + tip;
    if (here == 0 || here == deep) return false;
    const IndexBox<Dim> near = ringed<Dim>({element, uniform_index<Dim>(1)}, uniform_index<Dim>(reach));
    for (std::int64_t i = 0; i < near.count(); ++i)
      if (depth(near.index(i)) > here) return false;
    return true;
  }

  /// Thickness of the wall in the middle of which the element lies, in smallest spacings: that of its
  /// neighbour where this is more, because runs across the edge of a wall are short.
  double thickness(const Index<Dim>& element) const {
    double largest = shortest_run(element);
    for (const Index<Dim>& step : steps_) {
      const Index<Dim> other = moved<Dim>(element, step, 1);
      if (depth(other) == depth(element)) largest = std::max(largest, shortest_run(other));
    }
    return largest;
  }

 private:
  /// Length of the shortest run of elements through this one, in smallest spacings.
  double shortest_run(const Index<Dim>& element) const {
    double shortest = thick_wall;
    const double unit = *std::min_element(spacing_.begin(), spacing_.end());
    for (std::size_t i = 0; i < steps_.size() / 2; ++i) {
      double square = 0.0;
      for (int axis = 0; axis < Dim; ++axis) square += std::pow(steps_[i][axis] * spacing_[axis] / unit, 2);
      const int run = 1 + elements_ahead(element, steps_[i], 1) + elements_ahead(element, steps_[i], -1);
      shortest = std::min(shortest, run * std::sqrt(square));
    }
    return shortest;
  }

  int depth(const Index<Dim>& element) const {
    return halo_.box().contains(element) ? depth_[halo_.box().offset(element)] : 0;
  }
  int least_around(const Index<Dim>& element, const std::vector<char>& depths) const {
    int least = deep;
    for (const Index<Dim>& step : steps_) {
      const Index<Dim> other = moved<Dim>(element, step, 1);
      least = std::min<int>(least, halo_.box().contains(other) ? depths[halo_.box().offset(other)] : 0);
    }
    return least;
  }
  int elements_ahead(const Index<Dim>& element, const Index<Dim>& step, int sign) const {
    int count = 0;
    while (count < halo_width && depth(moved<Dim>(element, step, sign * (count + 1))) > 0) ++count;
    return count;
  }

  ElementHalo<Dim> halo_;
  Point<Dim> spacing_;
  std::vector<Index<Dim>> steps_ = steps_around<Dim>();
  std::vector<char> depth_;  ///< of each element of the halo's box: 0 outside, 1 at the surface, ..., `deep`
};

}  // namespace

template <int Dim>
ThinWall<Dim> thinnest_wall(const Part<Dim>& part) {
  const Grid<Dim>& grid = part.grid();
  const Depths<Dim> depths(part);
  std::vector<double> walls;
  double least = thick_wall;
  for (const int offset : part.elements()) {
    const Index<Dim> element = grid.owned_elements().index(offset);
    walls.push_back(depths.is_middle_of_thin_wall(element) ? depths.thickness(element) : thick_wall);
    least = std::min(least, walls.back());
  }
  least = min(grid.comm(), least);
  return {least, part.first_place([&](std::size_t e) { return walls[e] == least; })};
}

FABSEQ_INSTANTIATE_FUNCTION(thinnest_wall);

}  // namespace fabseq
