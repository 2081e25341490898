// SPDX-License-Identifier: MIT
#include "fabseq/mesh/open_fractions.h"

#include "mesh/cut_elements.h"
#include "mesh/vectors.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

// The samples of an element are one group of points.
static_assert(samples_per_element <= WindingNumber::group_limit);
/// Distance from the nearest integer from which on a winding number is unclear; far above the error of
/// WindingNumber.
constexpr double unclear_from = 0.2;

bool is_inside(double winding) { return std::abs(winding) >= 0.5; }

/// Asks points of elements and keeps count of how clear the answers are.
class Questions {
 public:
  Questions(const WindingNumber& winding, const ElementLattice& lattice)
      : winding_(winding), lattice_(lattice), radius_(0.5 * norm(lattice.spacing)) {}

  /// Share of an element's samples that lie inside.
  double share(const Index<3>& element) {
    std::array<Point<3>, samples_per_element> points;
    const IndexBox<3> all = {{}, {samples_per_axis, samples_per_axis, samples_per_axis}};
    all.for_each([&](const Index<3>& sample, std::int64_t i) {
      Point<3> share;
      for (int axis = 0; axis < 3; ++axis) share[axis] = (sample[axis] + 0.5) / samples_per_axis;
      points[i] = point_at(element, share);
    });
    std::array<double, samples_per_element> values;
    winding_.at(points, point_at(element, {0.5, 0.5, 0.5}), radius_, values);
    int inside = 0;
    for (int i = 0; i < samples_per_element; ++i) inside += count(points[i], values[i]) ? 1 : 0;
    return static_cast<double>(inside) / samples_per_element;
  }

  /// 1 for the elements of `elements` whose centres lie inside, 0 for others, lexicographic. Only elements of
  /// `counted` count for clarity().
  std::vector<char> centers(const IndexBox<3>& elements, const IndexBox<3>& counted) {
    std::vector<char> inside(static_cast<std::size_t>(elements.count()));
    // Blocks start at multiples of their size, whatever is asked: what is shared with neighbours in a block,
    // the center and the radius, must not depend on it.
    IndexBox<3> blocks;
    for (int axis = 0; axis < 3; ++axis) {
      blocks.start[axis] = block_of(elements.start[axis]);
      blocks.size[axis] = block_of(elements.start[axis] + elements.size[axis] - 1) + 1 - blocks.start[axis];
    }
    std::vector<Index<3>> asked;
    std::vector<Point<3>> points;
    std::array<double, samples_per_element> values;
    blocks.for_each([&](const Index<3>& block, std::int64_t) {
      const IndexBox<3> whole = {{block[0] * block_size, block[1] * block_size, block[2] * block_size},
                                 {block_size, block_size, block_size}};
      asked.clear();
      points.clear();
      whole.for_each([&](const Index<3>& element, std::int64_t) {
        if (!elements.contains(element)) return;
        asked.push_back(element);
        points.push_back(point_at(element, {0.5, 0.5, 0.5}));
      });
      const double half = 0.5 * block_size;
      winding_.at(points, point_at(whole.start, {half, half, half}), block_size * radius_, values);
      for (std::size_t i = 0; i < points.size(); ++i)
        inside[elements.offset(asked[i])] =
            counted.contains(asked[i]) ? count(points[i], values[i]) : is_inside(values[i]);
    });
    return inside;
  }

  const Clarity& clarity() const { return clarity_; }

 private:
  static constexpr int block_size = samples_per_axis;

  static int block_of(int index) {
    return index >= 0 ? index / block_size : -((block_size - 1 - index) / block_size);
  }

  Point<3> point_at(const Index<3>& element, Point<3> share) const {
    for (int axis = 0; axis < 3; ++axis) share[axis] += sample_shift[axis];
    return lattice_.point_of(element, share);
  }

  /// Notes an answer; returns whether it is "inside".
  bool count(const Point<3>& point, double winding) {
    const double modulus = std::abs(winding);
    if (clarity_.asked == 0 || std::abs(modulus - 0.5) < std::abs(std::abs(clarity_.least_winding) - 0.5)) {
      clarity_.least_clear = point;
      clarity_.least_winding = winding;
    }
    ++clarity_.asked;
    if (std::abs(modulus - std::round(modulus)) > unclear_from) ++clarity_.unclear;
    return is_inside(winding);
  }

  const WindingNumber& winding_;
  const ElementLattice& lattice_;
  double radius_;  ///< half the diagonal of an element
  Clarity clarity_;
};

}  // namespace

FillFractions open_fractions(const TriangleMesh& mesh, const WindingNumber& winding,
                             const ElementLattice& lattice, const IndexBox<3>& box) {
  if (box.count() == 0) return {};
  const IndexBox<3> wider = ringed(box);
  Questions ask(winding, lattice);
  const std::vector<char> cut = cut_elements(mesh, lattice, box), inside = ask.centers(wider, box);
  const std::array<std::int64_t, 3> steps = {1, wider.size[0],
                                             static_cast<std::int64_t>(wider.size[0]) * wider.size[1]};
  FillFractions result;
  result.of_element.resize(cut.size());
  box.for_each([&](const Index<3>& element, std::int64_t offset) {
    const std::int64_t here = wider.offset(element);
    // Where the surface is missing, elements that no triangle touches may still have parts inside and
    // outside, and then a neighbour is likely to give another answer.
    const bool contradicted = std::any_of(steps.begin(), steps.end(), [&](std::int64_t step) {
      return inside[here - step] != inside[here] || inside[here + step] != inside[here];
    });
    result.of_element[offset] = cut[offset] != 0 || contradicted ? ask.share(element) : inside[here];
  });
  result.clarity = ask.clarity();
  return result;
}

}  // namespace fabseq
