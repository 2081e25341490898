// SPDX-License-Identifier: MIT
#include "fabseq/machine/interior_extrema.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <cmath>
#include <numeric>

namespace fabseq {

// Of what is not in the part: before and after all pseudo-times.
constexpr double of_substrate = -1.0, of_void = 2.0;

template <int Dim>
InteriorExtrema find_interior_extrema(const Part<Dim>& part, std::span<const double> time) {
  const Grid<Dim>& grid = part.grid();
  const ElementHalo<Dim> halo(grid, 1);
  const std::vector<double> times = halo.gather(part.expand(time, of_void, of_substrate));
  InteriorExtrema result;
  for (std::size_t e = 0; e < part.elements().size(); ++e) {
    const Index<Dim> element = grid.owned_elements().index(part.elements()[e]);
    bool minimum = !std::isfinite(part.contact_distance()[e]), maximum = true;
    for (int face = 0; face < 2 * Dim && (minimum || maximum); ++face) {
      Index<Dim> neighbour = element;
      neighbour[face / 2] += face % 2 == 0 ? -1 : 1;
      const bool in_box = halo.box().contains(neighbour);
      const double other = in_box ? times[halo.box().offset(neighbour)] : of_void;
      minimum = minimum && other >= time[e];
      maximum = maximum && other <= time[e];
    }
    result.minima.push_back(minimum ? 1.0 : 0.0);
    result.maxima.push_back(maximum ? 1.0 : 0.0);
  }
  return result;
}

template <int Dim>
std::int64_t count_interior_minima(const Part<Dim>& part, std::span<const double> time) {
  const std::vector<double> minima = find_interior_extrema(part, time).minima;
  const double count = std::accumulate(minima.begin(), minima.end(), 0.0);
  return sum(part.grid().comm(), static_cast<std::int64_t>(count));
}

FABSEQ_INSTANTIATE_FUNCTION(find_interior_extrema);
FABSEQ_INSTANTIATE_FUNCTION(count_interior_minima);

}  // namespace fabseq
