// SPDX-License-Identifier: MIT
#include "fabseq/machine/marked_elements.h"

#include "fabseq/base/mpi.h"

#include <algorithm>

namespace fabseq {

template <int Dim>
MarkedElements count_marked(const Part<Dim>& part, std::span<const double> marks,
                            std::span<const double> layer_index, int layers, MarkedPlace place) {
  const MPI_Comm comm = part.grid().comm();
  MarkedElements result;
  result.per_layer.assign(static_cast<std::size_t>(layers), 0);
  double marked = 0.0, volume = 0.0;
  for (std::size_t e = 0; e < marks.size(); ++e) {
    volume += part.part_density()[e];
    if (marks[e] <= 0.0) continue;
    ++result.per_layer[static_cast<std::size_t>(layer_index[e]) - 1];
    marked += part.part_density()[e];
    result.largest = std::max(result.largest, marks[e]);
  }
  sum_in_place(comm, result.per_layer);
  result.largest = max(comm, result.largest);
  result.share = sum(comm, marked) / sum(comm, volume);
  for (const std::int64_t count : result.per_layer) result.elements += count;
  if (result.elements == 0) return result;
  const auto first = std::find_if(result.per_layer.begin(), result.per_layer.end(),
                                  [](std::int64_t count) { return count > 0; });
  const double layer = static_cast<double>(first - result.per_layer.begin()) + 1.0;
  const Point<Dim> at = part.first_place([&](std::size_t e) {
    return place == MarkedPlace::largest ? marks[e] == result.largest
                                         : marks[e] > 0.0 && layer_index[e] == layer;
  });
  result.at.assign(at.begin(), at.end());
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(count_marked);

}  // namespace fabseq
