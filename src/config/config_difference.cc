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

std::string change(const std::string& pointer, const Json* then, const Json* now) {
  const auto text = [](const Json* value) { return value == nullptr ? "nothing" : shown(*value); };
  return pointer + " was " + text(then) + ", is " + text(now) + " now";
}

/// The first difference at a place or below it; "" if there is none.
std::string difference(const Json* then, const Json* now, const std::string& pointer) {
  if (std::find(free_keys.begin(), free_keys.end(), pointer) != free_keys.end()) return "";
  if (then == nullptr || now == nullptr) return change(pointer, then, now);
  std::string found;
  if (then->is_object() && now->is_object()) {
    Json of_both = *then;
    of_both.update(*now);
    for (auto it = of_both.begin(); found.empty() && it != of_both.end(); ++it)
      found = difference(find_member(*then, it.key()), find_member(*now, it.key()),
                         pointer_to(pointer, it.key()));
    return found;
  }
  if (then->is_array() && now->is_array() && then->size() == now->size()) {
    for (std::size_t i = 0; found.empty() && i < then->size(); ++i)
      found = difference(&(*then)[i], &(*now)[i], pointer_to(pointer, i));
    return found;
  }
  return *then == *now ? "" : change(pointer, then, now);
}

}  // namespace

std::string config_difference(const Json& then, const Json& now) { return difference(&then, &now, ""); }

}  // namespace fabseq
