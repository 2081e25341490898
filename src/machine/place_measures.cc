// SPDX-License-Identifier: MIT
#include "machine/place_measures.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

template <int Dim>
using Axes = std::array<Point<Dim>, Dim>;

/// Axes of a place: two within the layer, along which its moments are the largest and the least, then the
/// build direction.
template <int Dim>
Axes<Dim> axes_of(const Point<Dim>& direction, const std::array<Point<Dim>, Dim>& moments) {
  Axes<Dim> axes;
  axes[Dim - 1] = direction;
  if constexpr (Dim == 2) {
    axes[0] = {direction[1], -direction[0]};
  } else {
    // From the axis of the grid that lies most within the layer.
    const auto least = std::min_element(direction.begin(), direction.end(),
                                        [](double a, double b) { return std::abs(a) < std::abs(b); });
    Point<Dim> a{};
    a[least - direction.begin()] = 1.0;
    const double along = dot(a, direction);
    for (int i = 0; i < Dim; ++i) a[i] -= along * direction[i];
    const double length = std::sqrt(dot(a, a));
    for (double& entry : a) entry /= length;
    const Point<Dim> b = {direction[1] * a[2] - direction[2] * a[1],
                          direction[2] * a[0] - direction[0] * a[2],
                          direction[0] * a[1] - direction[1] * a[0]};
    const auto moment = [&](const Point<Dim>& v, const Point<Dim>& w) {
      double sum = 0.0;
      for (int i = 0; i < Dim; ++i) sum += v[i] * dot(moments[i], w);
      return sum;
    };
    const double difference = moment(a, a) - moment(b, b), mixed = 2.0 * moment(a, b);
    const double scale = 1e-9 * (moment(a, a) + moment(b, b));
    const double angle =
        std::abs(difference) < scale && std::abs(mixed) < scale ? 0.0 : 0.5 * std::atan2(mixed, difference);
    for (int i = 0; i < Dim; ++i) {
      axes[0][i] = std::cos(angle) * a[i] + std::sin(angle) * b[i];
      axes[1][i] = std::cos(angle) * b[i] - std::sin(angle) * a[i];
    }
  }
  return axes;
}

/// Sums over a place's elements. Those of whole numbers are the same on any number of ranks.
template <int Dim>
struct PlaceSums {
  static constexpr int entries = 2 + 2 * Dim + Dim * Dim;
  explicit PlaceSums(std::span<double> values) : values_(values) {}

  double& elements() const { return values_[0]; }
  double& density() const { return values_[1]; }
  double& first(int i) const { return values_[2 + i]; }            ///< moment of the indices
  double& direction(int i) const { return values_[2 + Dim + i]; }  ///< of building
  double& second(int i, int k) const { return values_[2 + 2 * Dim + i * Dim + k]; }

 private:
  std::span<double> values_;
};

/// Measures places in two passes over their elements: sums first, from which the axes follow, then extents
/// along these.
template <int Dim>
class PlaceMeasures {
 public:
  /// Collective.
  PlaceMeasures(const Part<Dim>& part, int places, std::span<const int> place_of, const CheckedLayers& layers)
      : part_(part), layers_(layers), place_of_(place_of), count_(static_cast<std::size_t>(places)) {
    sums_.assign(count_ * PlaceSums<Dim>::entries, 0.0);
    const Point<Dim> normal = part.plate().template normal<Dim>();
    for_each([&](std::size_t e, std::size_t p, const Index<Dim>& element) {
      const PlaceSums<Dim> sums = sums_of(p);
      sums.elements() += 1.0;
      sums.density() += part.part_density()[e];
      for (int i = 0; i < Dim; ++i) {
        sums.first(i) += element[i];
        sums.direction(i) += layers.direction.empty() ? normal[i] : layers.direction[e * Dim + i];
        for (int k = 0; k < Dim; ++k) sums.second(i, k) += 1.0 * element[i] * element[k];
      }
    });
    sum_in_place(part.grid().comm(), std::span<double>(sums_));
  }

  /// Collective.
  std::vector<Place> places(Fault fault, std::span<const double> marks, std::span<const double> figures) {
    std::vector<Place> result(count_);
    for (std::size_t p = 0; p < count_; ++p) {
      const PlaceSums<Dim> sums = sums_of(p);
      Place& place = result[p];
      place.fault = fault;
      place.elements = static_cast<std::int64_t>(sums.elements());
      place.volume = place.begins = sums.density() * part_.grid().element_volume();
      for (int i = 0; i < Dim; ++i)
        place.centre.push_back(part_.grid().domain().origin[i] +
                               (sums.first(i) / sums.elements() + 0.5) * part_.grid().spacing()[i]);
    }
    add_extremes(result, marks, figures);
    return result;
  }

 private:
  template <class Function>
  void for_each(const Function& f) const {
    for (std::size_t e = 0; e < place_of_.size(); ++e)
      if (place_of_[e] >= 0)
        f(e, static_cast<std::size_t>(place_of_[e]),
          part_.grid().owned_elements().index(part_.elements()[e]));
  }
  PlaceSums<Dim> sums_of(std::size_t place) {
    constexpr std::size_t entries = PlaceSums<Dim>::entries;
    return PlaceSums<Dim>(std::span(sums_).subspan(place * entries, entries));
  }

  Axes<Dim> axes(const PlaceSums<Dim>& sums) const {
    Point<Dim> direction;
    for (int i = 0; i < Dim; ++i) direction[i] = sums.direction(i);
    const double length = std::sqrt(dot(direction, direction));
    for (double& entry : direction) entry /= length;
    if (length < 1e-9 * sums.elements()) direction = part_.plate().template normal<Dim>();
    const Point<Dim>& spacing = part_.grid().spacing();
    std::array<Point<Dim>, Dim> moments;
    for (int i = 0; i < Dim; ++i)
      for (int k = 0; k < Dim; ++k)
        moments[i][k] = spacing[i] * spacing[k] *
                        (sums.second(i, k) - sums.first(i) * sums.first(k) / sums.elements() +
                         (i == k ? sums.elements() / 12.0 : 0.0));
    return axes_of<Dim>(direction, moments);
  }

  void add_extremes(std::vector<Place>& places, std::span<const double> marks,
                    std::span<const double> figures) {
    constexpr int axis_entries = 4, layer = axis_entries * Dim, mark = layer + 1, entries = mark + 1;
    const Point<Dim>& spacing = part_.grid().spacing();
    std::vector<Axes<Dim>> frames;
    for (std::size_t p = 0; p < count_; ++p) frames.push_back(axes(sums_of(p)));
    constexpr double none = -std::numeric_limits<double>::infinity();
    std::vector<double> extremes(count_ * entries, none), worst(count_, none);
    for_each([&](std::size_t e, std::size_t p, const Index<Dim>& element) {
      double* own = &extremes[p * entries];
      const auto raise = [own](int entry, double value) { own[entry] = std::max(own[entry], value); };
      const Point<Dim> centre = part_.grid().element_center(element);
      for (int i = 0; i < Dim; ++i) {
        raise(axis_entries * i, 0.5 * spacing[i] - centre[i]);
        raise(axis_entries * i + 1, centre[i] + 0.5 * spacing[i]);
        const double at = dot(frames[p][i], centre);
        double half = 0.0;
        for (int k = 0; k < Dim; ++k) half += 0.5 * std::abs(frames[p][i][k]) * spacing[k];
        raise(axis_entries * i + 2, half - at);
        raise(axis_entries * i + 3, half + at);
      }
      raise(layer, -layers_.layer_index[e]);
      raise(mark, marks[e]);
    });
    max_in_place(part_.grid().comm(), extremes);
    for_each([&](std::size_t e, std::size_t p, const Index<Dim>&) {
      if (marks[e] == extremes[p * entries + mark]) worst[p] = std::max(worst[p], figures[e]);
    });
    max_in_place(part_.grid().comm(), worst);
    for (std::size_t p = 0; p < count_; ++p) {
      const double* own = &extremes[p * entries];
      Place& place = places[p];
      for (int i = 0; i < Dim; ++i) {
        place.lower.push_back(-own[axis_entries * i]);
        place.upper.push_back(own[axis_entries * i + 1]);
        place.extent.push_back(own[axis_entries * i + 2] + own[axis_entries * i + 3]);
      }
      if (Dim == 3 && place.extent[0] < place.extent[1]) std::swap(place.extent[0], place.extent[1]);
      place.layer = static_cast<int>(-own[layer]);
      place.worst = worst[p];
    }
  }

  const Part<Dim>& part_;
  const CheckedLayers& layers_;
  std::span<const int> place_of_;
  std::size_t count_;
  std::vector<double> sums_;
};

}  // namespace

template <int Dim>
std::vector<Place> measured_places(const Part<Dim>& part, Fault fault, int count,
                                   std::span<const int> place_of, std::span<const double> marks,
                                   std::span<const double> figures, const CheckedLayers& layers) {
  return PlaceMeasures<Dim>(part, count, place_of, layers).places(fault, marks, figures);
}

FABSEQ_INSTANTIATE_FUNCTION(measured_places);

}  // namespace fabseq
