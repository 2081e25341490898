// SPDX-License-Identifier: MIT
#include "fabseq/repair/layer_repair.h"

#include "fabseq/base/mpi.h"
#include "repair/cut_time.h"
#include "repair/element_moves.h"
#include "repair/time_mending.h"

#include <map>
#include <utility>

namespace fabseq {

namespace {

/// Elements that are in another layer than before. Collective.
template <int Dim>
std::vector<MovedElement> moved_elements(const Part<Dim>& part, const CutTime<Dim>& before,
                                         const CutTime<Dim>& after) {
  std::vector<std::int64_t> own;
  for (std::size_t e = 0; e < before.layer.size(); ++e)
    if (before.layer[e] != after.layer[e])
      for (const std::int64_t entry : {number_in_grid(part, e), static_cast<std::int64_t>(before.layer[e]),
                                       static_cast<std::int64_t>(after.layer[e])})
        own.push_back(entry);
  const std::vector<std::int64_t> all = gather_all(part.grid().comm(), own);
  std::map<std::int64_t, MovedElement> sorted;
  for (std::size_t i = 0; i < all.size(); i += 3) {
    const Index<Dim> element = part.grid().all_elements().index(all[i]);
    sorted[all[i]] = {
        {element.begin(), element.end()}, static_cast<int>(all[i + 1]), static_cast<int>(all[i + 2])};
  }
  std::vector<MovedElement> result;
  for (auto& [number, moved] : sorted) result.push_back(std::move(moved));
  return result;
}

/// Elements that failed and do not now, or are in another layer. Collective.
template <int Dim>
std::int64_t repaired_elements(const Part<Dim>& part, const CutTime<Dim>& before, const CutTime<Dim>& after) {
  std::int64_t count = 0;
  for (std::size_t e = 0; e < before.layer.size(); ++e)
    count += before.layer[e] != after.layer[e] || (before.fails(e) && !after.fails(e)) ? 1 : 0;
  return sum(part.grid().comm(), count);
}

}  // namespace

template <int Dim>
std::optional<RepairedTime<Dim>> repair_layers(const Model<Dim>& model, const PseudoTime<Dim>& time,
                                               std::span<const double> layer_variables, double most_share) {
  if (model.settings.layers.multi_planar) return std::nullopt;
  const double most_elements = most_share * static_cast<double>(model.part.count());
  const auto layers = model.layers->make(layer_variables, model.layers->traits().last_beta, true, {});
  PseudoTime<Dim> own = time;
  const bool is_recorded = any(model.grid.comm(), time.gradient.empty() && !time.recorded_gradient.empty());
  if (is_recorded) std::swap(own.gradient, own.recorded_gradient);
  const CutTime<Dim> start = cut(model, *layers, std::move(own));
  if (start.in_all() == 0 || static_cast<double>(start.in_all()) > most_elements) return std::nullopt;
  CutTime<Dim> result = TimeMending<Dim>(model, *layers).mend(start, most_elements);
  if (result.in_all() > 0) result = move_elements(model, *layers, result, most_elements);
  if (!result.is_better_than(start)) return std::nullopt;
  LayerChanges changes{repaired_elements(model.part, start, result),
                       moved_elements(model.part, start, result)};
  if (static_cast<double>(changes.moved.size()) > most_elements) return std::nullopt;
  if (is_recorded) std::swap(result.time.gradient, result.time.recorded_gradient);
  return RepairedTime<Dim>{std::move(result.time), std::move(changes)};
}

FABSEQ_INSTANTIATE_FUNCTION(repair_layers);

}  // namespace fabseq
