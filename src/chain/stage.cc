// SPDX-License-Identifier: MIT
#include "fabseq/chain/stage.h"

#include <algorithm>
#include <stdexcept>

namespace fabseq {

namespace {

std::vector<const StageType*>& registered_stages() {
  static std::vector<const StageType*> types;
  return types;
}

bool has(const std::vector<ResultName>& names, const ResultName& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whether a makes what b reads. Of two that change a result, neither comes before the other for its sake.
bool leads_to(const StageType& a, const StageType& b) {
  return std::any_of(a.makes.begin(), a.makes.end(), [&](const ResultName& result) {
    return has(b.reads, result) && !(has(a.reads, result) && has(b.makes, result));
  });
}

}  // namespace

void register_stage(const StageType* type) {
  std::vector<const StageType*>& types = registered_stages();
  const auto is_less = [](const StageType* a, const StageType* b) { return a->name < b->name; };
  types.insert(std::upper_bound(types.begin(), types.end(), type, is_less), type);
}

std::vector<const StageType*> stage_types() {
  std::vector<const StageType*> waiting = registered_stages(), result;
  while (!waiting.empty()) {
    const auto next = std::find_if(waiting.begin(), waiting.end(), [&](const StageType* type) {
      return std::none_of(waiting.begin(), waiting.end(),
                          [&](const StageType* other) { return other != type && leads_to(*other, *type); });
    });
    if (next == waiting.end()) throw std::logic_error("stages read each other's results");
    result.push_back(*next);
    waiting.erase(next);
  }
  return result;
}

template <int Dim>
std::vector<std::unique_ptr<Stage<Dim>>> make_stages(StageContext<Dim> context) {
  std::vector<std::unique_ptr<Stage<Dim>>> result;
  for (const StageType* type : stage_types())
    if (auto stage = type->make(context)) result.push_back(std::move(stage));
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(make_stages);

}  // namespace fabseq
