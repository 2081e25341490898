// SPDX-License-Identifier: MIT
#include "fabseq/machine/meeting_fronts.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

/// Where fronts meet, the steepest differences to the neighbours are more than so many times the gradient.
constexpr double steeper = 2.0;

/// Times in the box around this rank's elements, not a number outside the part.
template <int Dim>
class TimesAround {
 public:
  /// Collective.
  TimesAround(const Part<Dim>& part, std::span<const double> time)
      : part_(part), halo_(part.grid(), 1), time_(halo_.gather(part.expand(time, outside))) {}

  /// Square of the steepest one-sided differences along all axes, 1/length^2.
  double steepness(int element) const {
    const Index<Dim> index = part_.grid().owned_elements().index(element);
    const double own = time_[halo_.box().offset(index)];
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) {
      double largest = 0.0;
      for (const int step : {-1, 1}) {
        Index<Dim> other = index;
        other[axis] += step;
        if (!halo_.box().contains(other)) continue;
        const double time = time_[halo_.box().offset(other)];
        if (!std::isnan(time)) largest = std::max(largest, std::abs(time - own));
      }
      square += std::pow(largest / part_.grid().spacing()[axis], 2);
    }
    return square;
  }

 private:
  static constexpr double outside = std::numeric_limits<double>::quiet_NaN();

  const Part<Dim>& part_;
  ElementHalo<Dim> halo_;
  std::vector<double> time_;
};

}  // namespace

template <int Dim>
std::vector<double> meeting_fronts(const Part<Dim>& part, std::span<const double> time,
                                   std::span<const double> gradient) {
  std::vector<double> result;
  if (!any(part.grid().comm(), !gradient.empty())) return result;
  const TimesAround<Dim> around(part, time);
  for (std::size_t e = 0; e < time.size(); ++e) {
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(gradient[e * Dim + axis], 2);
    const double steepest = around.steepness(part.elements()[e]);
    result.push_back(steepest > steeper * steeper * square ? 1.0 : 0.0);
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(meeting_fronts);

}  // namespace fabseq
