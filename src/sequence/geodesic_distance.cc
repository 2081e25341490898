#include "fabseq/sequence/geodesic_distance.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

constexpr double far_away = std::numeric_limits<double>::infinity();
/// Sweeping ends when no value changes by more than this share of itself.
constexpr double settled = 1e-13;

/// What an element's distance follows from along one axis: the smaller value of its two neighbours, and how
/// far they are.
struct Upwind {
  double value;
  double spacing;
};

/// Solution s of sum_a max(0, (s - value_a) / spacing_a)^2 = 1 (Godunov's upwind scheme). The left side grows
/// with s, and only axes with value_a < s count, so axes are taken in ascending order of their values until
/// the next one lies above s.
template <int Dim>
double solve_upwind(std::array<Upwind, Dim> neighbors) {
  std::sort(neighbors.begin(), neighbors.end(),
            [](const Upwind& a, const Upwind& b) { return a.value < b.value; });
  const double base = neighbors[0].value;
  if (base == far_away) return far_away;
  // With r = s - base, u_a = value_a - base, w_a = 1/spacing_a^2:  A r^2 - 2 B r + C = 0.
  double a = 0.0, b = 0.0, c = -1.0, r = far_away;
  for (const Upwind& neighbor : neighbors) {
    const double u = neighbor.value - base;
    if (u >= r) break;
    const double w = 1.0 / (neighbor.spacing * neighbor.spacing);
    a += w;
    b += w * u;
    c += w * u * u;
    r = (b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
  }
  return base + r;
}

/// The distances of this rank's part elements and of the elements around them, and the sweeps over them.
template <int Dim>
class Sweeper {
 public:
  explicit Sweeper(const Part<Dim>& part) : part_(part), halo_(part.grid(), ones()) {
    const Grid<Dim>& grid = part.grid();
    const IndexBox<Dim>& owned = grid.owned_elements();
    std::vector<double> start(static_cast<std::size_t>(owned.count()), far_away);
    free_.assign(start.size(), 0);
    for (std::size_t e = 0; e < part.elements().size(); ++e) {
      start[part.elements()[e]] = part.contact_distance()[e];
      free_[part.elements()[e]] = std::isfinite(part.contact_distance()[e]) ? 0 : 1;
    }
    values_ = halo_.gather(start);
    std::int64_t stride = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      strides_[axis] = stride;
      stride *= halo_.box().size[axis];
    }
  }

  /// Sweeps in all directions over this rank's elements; true if a value changed.
  bool sweep() {
    bool changed = false;
    for (int direction = 0; direction < (1 << Dim); ++direction) changed |= sweep(direction);
    return changed;
  }
  /// Takes over what the neighbours have found; true if that was anything new. Collective.
  bool exchange() {
    std::vector<double> gathered = halo_.gather(owned_values());
    const bool news = gathered != values_;
    values_ = std::move(gathered);
    return news;
  }

  std::vector<double> owned_values() const {
    const IndexBox<Dim>& owned = part_.grid().owned_elements();
    std::vector<double> result(static_cast<std::size_t>(owned.count()));
    owned.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      result[offset] = values_[halo_.box().offset(element)];
    });
    return result;
  }

 private:
  static Index<Dim> ones() {
    Index<Dim> result;
    result.fill(1);
    return result;
  }

  /// Bit a of `direction`: from the upper end of axis a.
  bool sweep(int direction) {
    const IndexBox<Dim>& owned = part_.grid().owned_elements();
    bool changed = false;
    owned.for_each([&](const Index<Dim>& forward, std::int64_t) {
      Index<Dim> element = forward;
      for (int axis = 0; axis < Dim; ++axis)
        if ((direction >> axis) & 1)
          element[axis] = 2 * owned.start[axis] + owned.size[axis] - 1 - forward[axis];
      if (free_[owned.offset(element)] != 0) changed |= update(element);
    });
    return changed;
  }

  bool update(const Index<Dim>& element) {
    const IndexBox<Dim>& box = halo_.box();
    const std::int64_t here = box.offset(element);
    std::array<Upwind, Dim> neighbors;
    for (int axis = 0; axis < Dim; ++axis) {
      const bool below = element[axis] > box.start[axis];
      const bool above = element[axis] + 1 < box.start[axis] + box.size[axis];
      neighbors[axis] = {std::min(below ? values_[here - strides_[axis]] : far_away,
                                  above ? values_[here + strides_[axis]] : far_away),
                         part_.grid().spacing()[axis]};
    }
    const double value = solve_upwind<Dim>(neighbors);
    if (!(value < values_[here])) return false;
    const bool changed = values_[here] - value > settled * value;
    values_[here] = value;
    return changed;
  }

  const Part<Dim>& part_;
  ElementHalo<Dim> halo_;
  std::vector<double> values_;  ///< on halo_.box(), far_away outside the part and where nothing is known yet
  std::vector<char> free_;      ///< owned part elements that are not on the plate
  std::array<std::int64_t, Dim> strides_{};
};

}  // namespace

template <int Dim>
std::vector<double> geodesic_distance(const Part<Dim>& part) {
  Sweeper<Dim> sweeper(part);
  // Values only fall, and the scheme has one solution, whatever the order of updates: so ranks may sweep on
  // their own.
  bool unsettled = true;
  while (true) {
    const bool changed = unsettled && sweeper.sweep();
    if (!any(part.grid().comm(), changed)) break;
    unsettled = sweeper.exchange() || changed;
  }
  return part.restrict_to_part(sweeper.owned_values());
}

template <int Dim>
double geodesic_height(const Part<Dim>& part, const std::vector<double>& distance) {
  double farthest = 0.0;
  for (const double value : distance) farthest = std::max(farthest, value);
  return max(part.grid().comm(), farthest) + 0.5 * part.grid().spacing()[part.plate().axis];
}

template std::vector<double> geodesic_distance<2>(const Part<2>&);
template std::vector<double> geodesic_distance<3>(const Part<3>&);
template double geodesic_height<2>(const Part<2>&, const std::vector<double>&);
template double geodesic_height<3>(const Part<3>&, const std::vector<double>&);

}  // namespace fabseq
