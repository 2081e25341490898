// SPDX-License-Identifier: MIT
#include "config/config_keys.h"
#include "fabseq/base/error.h"
#include "fabseq/keys/check_value.h"

#include <algorithm>

namespace fabseq {

namespace {

using Keys = std::vector<const ConfigKey*>;

std::vector<std::string> names(const Keys& keys) {
  std::vector<std::string> result;
  for (const ConfigKey* key : keys) result.emplace_back(key->name);
  return result;
}

std::string name_list(const Keys& keys) { return join(names(keys), ", "); }

/// The section that has a key of this name, if it is the only one; else "".
std::string section_with(const std::string& name) {
  std::string found;
  for (const SectionKeys& section : config_sections())
    for (const ConfigKey& key : section.keys)
      if (key.name == name && section.path != found) {
        if (!found.empty()) return "";
        found = section.path.empty() ? "the config itself" : section.path;
      }
  return found;
}

[[noreturn]] void refuse_unknown_key(const std::string& pointer, const std::string& name,
                                     std::string_view path, const std::string& variant, const Keys& keys) {
  std::string message = pointer_to(pointer, name) + ": unknown key";
  if (!variant.empty()) message += " for type \"" + variant + "\"";
  const std::string nearest = nearest_word(name, names(keys));
  const std::string home = nearest.empty() ? section_with(name) : "";
  if (!home.empty() && home != path)
    message += "; it is a key of " + home + ";";
  else
    message += nearest.empty() ? ";" : "; did you mean \"" + nearest + "\"?";
  throw InputError(message + " allowed here: " + name_list(keys));
}

/// Checks one document against the declared keys and fills in defaults.
class Completion {
 public:
  Completion(int dimension, std::string directory) : context_{dimension, std::move(directory)} {}

  /// The object `value`, completed with the keys of a section.
  Json section(const Json& value, const std::string& pointer, const std::string& path) const {
    if (!value.is_object()) refuse(pointer, shown(value), "an object");
    const std::string variant = variant_of(value, pointer, path);
    const Keys keys = keys_of(path, variant);
    refuse_strangers(value, pointer, path, variant, keys);
    Json result = Json::object();
    for (const ConfigKey* key : keys) add(result, *key, find_member(value, key->name), pointer);
    return result;
  }

 private:
  /// Declarations of a section.
  static const std::vector<ConfigKey>& declared(std::string_view path) {
    const auto& sections = config_sections();
    return std::find_if(sections.begin(), sections.end(),
                        [&](const SectionKeys& section) { return section.path == path; })
        ->keys;
  }

  /// Keys of a section that exist in this dimension and for this type of the object.
  Keys keys_of(std::string_view path, std::string_view variant) const {
    Keys result;
    for (const ConfigKey& key : declared(path)) {
      if (!key.variant.empty() && key.variant != variant) continue;
      if (key.dimension == 0 || key.dimension == context_.dimension) result.push_back(&key);
    }
    return result;
  }

  /// The "type" of the object; empty if the section has no such key.
  std::string variant_of(const Json& value, const std::string& pointer, const std::string& path) const {
    Json holder = Json::object();
    for (const ConfigKey& key : declared(path))
      if (key.name == "type") add(holder, key, find_member(value, "type"), pointer);
    return holder.value("type", "");
  }

  /// Refuses members that are not among `keys`, which are those of the section `path` in this dimension and
  /// maybe others.
  void refuse_strangers(const Json& value, const std::string& pointer, std::string_view path,
                        const std::string& variant, const Keys& keys) const {
    for (const auto& [name, found] : value.items()) {
      const auto same = [&name = name](const ConfigKey* key) { return key->name == name; };
      if (std::any_of(keys.begin(), keys.end(), same)) continue;
      refuse_other_dimension(pointer_to(pointer, name), found, path, name);
      refuse_unknown_key(pointer, name, path, variant, keys);
    }
  }

  /// Refuses a key that exists only in domains of another dimension with a better message than "unknown key".
  void refuse_other_dimension(const std::string& pointer, const Json& found, std::string_view path,
                              const std::string& name) const {
    for (const ConfigKey& key : declared(path)) {
      if (key.name != name || key.dimension == 0) continue;
      const std::string dimension = std::to_string(key.dimension);
      refuse(pointer, shown(found),
             "only in " + dimension + "D, that is with " + dimension + " entries in domain.elements");
    }
  }

  /// Adds the checked value of a key, or its default, to `result`.
  void add(Json& result, const ConfigKey& key, const Json* given, const std::string& parent) const {
    const std::string& name = key.name;
    const std::string pointer = pointer_to(parent, name);
    if (given != nullptr) {
      result[name] = checked(key, *given, pointer);
      return;
    }
    if (key.required)
      throw InputError(pointer + ": missing; allowed: " + allowed_values(key, context_.dimension));
    const bool other = context_.dimension == 2 && !key.default_2d.empty();
    const std::string& text = other ? key.default_2d : key.default_value;
    if (!text.empty()) result[name] = checked(key, parse_json(text, "default of " + name), pointer);
  }

  Json checked(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    switch (key.type) {
      case KeyType::shapes:
      case KeyType::sections:
        return list(key, value, pointer);
      case KeyType::section:
        return section(value, pointer, subsection(key));
      case KeyType::shape:
        return value.is_string() && !key.words.empty() ? checked_value(key, value, pointer, context_)
                                                       : shape(value, pointer, "");
      case KeyType::part:
        return shape(value, pointer, "part");
      case KeyType::node_sets:
        return node_set_map(key, value, pointer);
      default:
        return checked_value(key, value, pointer, context_);
    }
  }

  Json list(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    const bool of_shapes = key.type == KeyType::shapes;
    if (!value.is_array() || (of_shapes && value.empty())) refuse_value(key, value, pointer, context_);
    Json result = Json::array();
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string place = pointer_to(pointer, i);
      result.push_back(of_shapes ? shape(value[i], place, "") : section(value[i], place, subsection(key)));
    }
    return result;
  }

  Json node_set_map(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!value.is_object()) refuse_value(key, value, pointer, context_);
    Json result = Json::object();
    for (const auto& [name, member] : value.items()) {
      result[name] = shape(member, pointer_to(pointer, name), "node_sets.NAME");
    }
    return result;
  }

  /// Completes an object with exactly one of its sources (a shape, voxels, ...) and the further keys of the
  /// section `extra`.
  Json shape(const Json& value, const std::string& pointer, const std::string& extra) const {
    Keys keys = keys_of("shape", ""), sources, given;
    if (!extra.empty()) {
      for (const ConfigKey* key : keys_of(extra, "")) keys.push_back(key);
    }
    const auto is_source = [](const ConfigKey* key) { return key->source; };
    std::copy_if(keys.begin(), keys.end(), std::back_inserter(sources), is_source);
    if (!value.is_object()) refuse(pointer, shown(value), "an object with one of " + name_list(sources));
    refuse_strangers(value, pointer, "shape", "", keys);
    const auto is_given = [&](const ConfigKey* key) {
      const Json* member = find_member(value, key->name);
      return member != nullptr && *member != false;
    };
    std::copy_if(sources.begin(), sources.end(), std::back_inserter(given), is_given);
    if (given.size() != 1) {
      refuse(pointer, given.empty() ? "no shape" : name_list(given), "exactly one of " + name_list(sources));
    }
    Json result = Json::object();
    for (const ConfigKey* key : keys) {
      if (!is_source(key) || key == given.front()) add(result, *key, find_member(value, key->name), pointer);
    }
    return result;
  }

  ValueContext context_;
};

/// Dimension of the domain, by the number of entries of domain.elements, 3 if there are none. Other faults in
/// them are found later.
int find_dimension(const Json& document) {
  const Json* elements = find_member(document, "domain", "elements");
  if (elements == nullptr) return 3;
  const bool valid = elements->is_array() && (elements->size() == 2 || elements->size() == 3);
  if (!valid) refuse("/domain/elements", shown(*elements), "a list of 2 or 3 integers >= 1");
  return static_cast<int>(elements->size());
}

}  // namespace

Json complete_config(const Json& document, const std::string& directory) {
  if (!document.is_object()) refuse("", shown(document), "an object");
  Json input = Json::object();
  for (const auto& [name, value] : document.items()) {
    if (name != "run") input[name] = value;  // "run" records the run that wrote the file
  }
  return complete_section(input, "", "", find_dimension(input), directory);
}

Json complete_section(const Json& value, const std::string& pointer, const std::string& path, int dimension,
                      const std::string& directory) {
  return Completion(dimension, directory).section(value, pointer, path);
}

}  // namespace fabseq
