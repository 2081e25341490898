// SPDX-License-Identifier: MIT
#include "fabseq/sequence/even_time.h"

#include "fabseq/base/mpi.h"
#include "fabseq/sequence/element_means.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "sequence/start_domain.h"

#include <algorithm>
#include <utility>

namespace fabseq {

template <int Dim>
EvenTime<Dim> even_time(const Part<Dim>& part) {
  const Grid<Dim>& grid = part.grid();
  const std::vector<double> distance = geodesic_distance_of_nodes<Dim>(part, start_domain(part).fixed);
  double height = 0.0;
  for (std::size_t node = 0; node < distance.size(); ++node)
    if (part.touched_nodes()[node] != 0) height = std::max(height, distance[node]);
  EvenTime<Dim> result;
  result.height = max(grid.comm(), height);
  const ElementMatrices<Dim> element(grid.spacing(), grid.domain().thickness, 0.0);
  ElementMeans means = element_means<Dim>(part, element, grid.exchange(1).ghosted(distance));
  for (auto* values : {&means.mean, &means.gradient})
    for (double& value : *values) value /= result.height;
  result.time.time = std::move(means.mean);
  result.time.gradient = std::move(means.gradient);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(even_time);

}  // namespace fabseq
