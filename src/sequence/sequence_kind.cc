// SPDX-License-Identifier: MIT
#include "fabseq/sequence/sequence_kind.h"

#include <algorithm>
#include <tuple>

namespace fabseq {

namespace {

/// All registered kinds. It grows during static initialization.
std::vector<const SequenceKind*>& registry() {
  static std::vector<const SequenceKind*> kinds;
  return kinds;
}

}  // namespace

void register_kind(const SequenceKind* kind) { registry().push_back(kind); }

std::vector<const SequenceKind*> sequence_kinds() {
  std::vector<const SequenceKind*> result = registry();
  std::sort(result.begin(), result.end(), [](const SequenceKind* a, const SequenceKind* b) {
    return std::tie(a->position, a->name) < std::tie(b->position, b->name);
  });
  return result;
}

std::vector<std::string> of_sequence_kinds(std::string SequenceTraits::*trait) {
  std::vector<std::string> result;
  for (const SequenceKind* kind : sequence_kinds())
    if (!(kind->*trait).empty()) result.push_back(kind->*trait);
  return result;
}

std::string sequences_with_gradient() {
  // Those with conditions stand last, where the condition cannot be taken for that of all.
  std::vector<std::string> always, sometimes;
  for (const SequenceKind* kind : sequence_kinds())
    if (!kind->with_gradient.empty())
      (kind->with_gradient == kind->name ? always : sometimes).push_back(kind->with_gradient);
  always.insert(always.end(), sometimes.begin(), sometimes.end());
  if (always.size() > 1) always.back() = "or " + always.back();
  return join(always, ", ");
}

std::vector<SectionKeys> sequence_keys() {
  SectionKeys own{"sequence", "Fabrication sequence", {}};
  own.keys.push_back({.type = KeyType::choice,
                      .required = true,
                      .words = join(of_sequence_kinds(&SequenceTraits::name), " "),
                      .name = "type",
                      .meaning = "Where the pseudo-time comes from",
                      .section = own.path});
  std::vector<SectionKeys> further;
  for (const SequenceKind* kind : sequence_kinds())
    for (SectionKeys& declared : kind->keys()) {
      if (declared.path != own.path) {
        further.push_back(std::move(declared));
        continue;
      }
      for (ConfigKey& key : declared.keys) {
        key.variant = kind->name;
        own.keys.push_back(std::move(key));
      }
    }
  further.insert(further.begin(), std::move(own));
  return further;
}

SequenceSettings read_sequence(const Json& object, const KeyPlace& place) {
  const auto kinds = sequence_kinds();
  const auto is_asked_for = [&](const SequenceKind* kind) { return object.at("type") == kind->name; };
  return (*std::find_if(kinds.begin(), kinds.end(), is_asked_for))->read(object, place);
}

}  // namespace fabseq
