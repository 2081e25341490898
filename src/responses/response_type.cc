// SPDX-License-Identifier: MIT
#include "fabseq/responses/response_type.h"

#include <algorithm>

namespace fabseq {

namespace {

/// All registered types. It grows during static initialization.
std::vector<const ResponseType*>& registry() {
  static std::vector<const ResponseType*> types;
  return types;
}

/// The keys that all objective terms have; the declarations of some of them depend on the type.
Section<Term> common_objective_keys() {
  Section<Term> result("objective", "Objective: a list of terms");
  const auto types = response_types(TermList::objective);
  for (const ResponseType* type : types)
    result.only_for(type->name)
        .key("weight", &Term::weight, "Weight of the term",
             {.default_value = to_text(type->weight), .range = "[0, inf)", .option = type->weight_option});
  result.only_for("").key("normalize", &Term::normalize, "Value the term is scaled to",
                          {.range = "(0, inf)"});
  for (const ResponseType* type : types)
    result.only_for(type->name)
        .key("scaling", &Term::scaling, "Scaled at the first or at every iteration",
             {.default_value = to_text(type->scaling == TermScaling::first ? "first" : "current"),
              .words = "first current"});
  return result;
}

}  // namespace

std::string name_of(LayerKind kind) {
  return kind == LayerKind::any ? "" : kind == LayerKind::curved ? "curved" : "multi_planar";
}

void register_type(const ResponseType* type) { registry().push_back(type); }

std::vector<const ResponseType*> response_types(TermList list) {
  std::vector<const ResponseType*> result;
  std::copy_if(registry().begin(), registry().end(), std::back_inserter(result),
               [&](const ResponseType* type) { return type->list == list; });
  std::sort(result.begin(), result.end(),
            [](const ResponseType* a, const ResponseType* b) { return a->name < b->name; });
  return result;
}

const ResponseType* find_response_type(TermList list, const std::string& name) {
  for (const ResponseType* type : response_types(list))
    if (type->name == name) return type;
  return nullptr;
}

bool any_measures_release(const std::vector<Term>& terms) {
  return std::any_of(terms.begin(), terms.end(),
                     [](const Term& term) { return term.type->facts(term).measures_release; });
}

SectionKeys term_keys(TermList list) {
  const bool objective = list == TermList::objective;
  const SectionKeys common = objective ? common_objective_keys().declarations().front()
                                       : SectionKeys{"constraints", "Constraints: a list", {}};
  SectionKeys result{common.path, common.title, {}};
  ConfigKey type{.type = KeyType::choice, .required = true, .name = "type", .section = common.path};
  type.meaning = objective ? "Kind of term" : "Kind of constraint";
  result.keys.push_back(type);
  std::string words;
  for (const ResponseType* response : response_types(list)) {
    words += (words.empty() ? "" : " ") + response->name;
    for (ConfigKey& key : response->keys()) {
      key.section = common.path;
      key.variant = response->name;
      result.keys.push_back(std::move(key));
    }
  }
  result.keys.front().words = words;
  result.keys.insert(result.keys.end(), common.keys.begin(), common.keys.end());
  return result;
}

Term make_term(TermList list, const Json& object) {
  static const Section<Term> common = common_objective_keys();
  Term term;
  term.type = find_response_type(list, object.at("type").get<std::string>());
  term.own = term.type->read(object);
  if (list == TermList::objective) common.read(term, object, {"", 0});
  return term;
}

}  // namespace fabseq
