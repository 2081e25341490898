// SPDX-License-Identifier: MIT
#include "repair/cut_time.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace fabseq {

template <int Dim>
bool CutTime<Dim>::fails(std::size_t element) const {
  return std::any_of(marks.begin(), marks.end(), [element](const std::vector<double>& of_check) {
    return !of_check.empty() && of_check[element] > 0.0;
  });
}

template <int Dim>
std::int64_t CutTime<Dim>::in_all() const {
  return std::accumulate(failing.begin(), failing.end(), std::int64_t{0});
}

template <int Dim>
bool CutTime<Dim>::is_better_than(const CutTime& other) const {
  for (std::size_t i = 0; i < failing.size(); ++i)
    if (failing[i] > other.failing[i]) return false;
  return in_all() < other.in_all();
}

template <int Dim>
CutTime<Dim> cut(const Model<Dim>& model, const Layers& layers, PseudoTime<Dim> time) {
  CutTime<Dim> result;
  result.time = std::move(time);
  layers.set_densities(result.time.time, result.densities);
  result.layer = layers.layer_index(result.time.time, result.densities);
  const BuildReport report =
      check_layers(model, result.time, result.densities, result.layer, /*with_places=*/false);
  for (std::size_t i = 0; i < all_faults.size(); ++i) {
    auto marks = fault_marks(report.fields, model.settings, all_faults[i]);
    if (!marks) continue;
    result.marks[i] = *std::move(marks);
    result.failing[i] =
        std::count_if(result.marks[i].begin(), result.marks[i].end(), [](double mark) { return mark > 0.0; });
  }
  sum_in_place(model.grid.comm(), std::span<std::int64_t>(result.failing));
  return result;
}

template <int Dim>
std::int64_t count_moved(const Part<Dim>& part, const CutTime<Dim>& from, const CutTime<Dim>& to) {
  std::int64_t count = 0;
  for (std::size_t e = 0; e < from.layer.size(); ++e) count += from.layer[e] != to.layer[e] ? 1 : 0;
  return sum(part.grid().comm(), count);
}

FABSEQ_INSTANTIATE_STRUCT(CutTime);
FABSEQ_INSTANTIATE_FUNCTION(count_moved);
FABSEQ_INSTANTIATE_FUNCTION(cut);

}  // namespace fabseq
