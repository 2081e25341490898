// SPDX-License-Identifier: MIT
#include "fabseq/config/config_difference.h"

#include "fabseq/keys/config_key.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace fabseq {

namespace {

/// JSON pointers of keys that may change, with all keys below them.
constexpr std::array<std::string_view, 12> free_keys = {"/name",
                                                        "/output",
                                                        "/run",
                                                        "/solver",
                                                        "/optimizer/max_iterations",
                                                        "/optimizer/change_tolerance",
                                                        "/optimizer/objective_tolerance",
                                                        "/optimizer/window",
                                                        "/optimizer/later_iterations",
                                                        "/part/voxels/file",
                                                        "/part/mesh/file",
                                                        "/domain/unit"};

bool same_value(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return a.get<double>() == b.get<double>();
  return a.dump() == b.dump();
}

std::string change(const std::string& pointer, const Json* then, const Json* now) {
  const auto text = [](const Json* value) { return value == nullptr ? "nothing" : shown(*value); };
  return pointer + " was " + text(then) + ", is " + text(now) + " now";
}

std::string difference(const Json* then, const Json* now, const std::string& pointer);

std::string difference_of_members(const Json& then, const Json& now, const std::string& pointer) {
  for (const auto& [key, value] : then.items()) {
    std::string found = difference(&value, find_member(now, key), pointer_to(pointer, key));
    if (!found.empty()) return found;
  }
  for (const auto& [key, value] : now.items()) {
    if (find_member(then, key) != nullptr) continue;
    std::string found = difference(nullptr, &value, pointer_to(pointer, key));
    if (!found.empty()) return found;
  }
  return "";
}

std::string difference(const Json* then, const Json* now, const std::string& pointer) {
  if (std::find(free_keys.begin(), free_keys.end(), pointer) != free_keys.end()) return "";
  if (then == nullptr || now == nullptr) return change(pointer, then, now);
  if (then->is_object() && now->is_object()) return difference_of_members(*then, *now, pointer);
  if (then->is_array() && now->is_array() && then->size() == now->size()) {
    for (std::size_t i = 0; i < then->size(); ++i) {
      std::string found = difference(&(*then)[i], &(*now)[i], pointer_to(pointer, i));
      if (!found.empty()) return found;
    }
    return "";
  }
  return same_value(*then, *now) ? "" : change(pointer, then, now);
}

}  // namespace

std::string config_difference(const Json& then, const Json& now) { return difference(&then, &now, ""); }

}  // namespace fabseq
