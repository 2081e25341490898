#include "fabseq/base/error.h"
#include "fabseq/io/schema.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace fabseq {

namespace {

using Keys = std::vector<const ConfigKey*>;

std::vector<std::string> names(const Keys& keys) {
  std::vector<std::string> result;
  for (const ConfigKey* key : keys) {
    if (key->type != KeyType::unavailable) result.emplace_back(key->name);
  }
  return result;
}

std::string name_list(const Keys& keys) { return join(names(keys), ", "); }

[[noreturn]] void refuse_unknown_key(const std::string& pointer, const std::string& name,
                                     const std::string& variant, const Keys& keys) {
  std::string message = pointer_to(pointer, name) + ": unknown key";
  if (!variant.empty()) message += " for type \"" + variant + "\"";
  const std::string nearest = nearest_word(name, names(keys));
  message += nearest.empty() ? ";" : "; did you mean \"" + nearest + "\"?";
  throw InputError(message + " allowed here: " + name_list(keys));
}

bool has_word(std::string_view words, const Json& value) {
  if (!value.is_string()) return false;
  const std::vector<std::string> list = split(words, ' ');
  return std::find(list.begin(), list.end(), value.string()) != list.end();
}

/// Fills in one document against the table.
class Completion {
 public:
  Completion(int dimension, std::string directory)
      : dimension_(dimension), directory_(std::move(directory)) {}

  /// The object `value` with the keys of a section, complete.
  Json section(const Json& value, const std::string& pointer, const std::string& path) const {
    if (!value.is_object()) refuse(pointer, shown(value), "an object");
    const std::string variant = variant_of(value, pointer, path);
    const Keys keys = keys_of(path, variant);
    refuse_strangers(value, pointer, path, variant, keys);
    Json result = Json::object();
    for (const ConfigKey* key : keys) add(result, *key, value.find(std::string(key->name)), pointer);
    return result;
  }

 private:
  /// Keys of a section that exist in this dimension.
  Keys keys_of(std::string_view path, std::string_view variant) const {
    Keys result;
    for (const ConfigKey& key : config_keys()) {
      if (key.section != path || (!key.variant.empty() && key.variant != variant)) continue;
      if (key.dimension == 0 || key.dimension == dimension_) result.push_back(&key);
    }
    return result;
  }

  /// The object's "type", if the table has keys that depend on it.
  std::string variant_of(const Json& value, const std::string& pointer, const std::string& path) const {
    const ConfigKey* type = nullptr;
    bool varies = false;
    for (const ConfigKey& key : config_keys()) {
      if (key.section != path) continue;
      if (key.name == "type") type = &key;
      varies = varies || !key.variant.empty();
    }
    if (type == nullptr || !varies) return "";
    Json holder = Json::object();
    add(holder, *type, value.find("type"), pointer);
    return holder.at("type").string();
  }

  /// Refuses members that are none of `keys`, those of the section `path` in this dimension and maybe others.
  void refuse_strangers(const Json& value, const std::string& pointer, std::string_view path,
                        const std::string& variant, const Keys& keys) const {
    for (const auto& [name, found] : value.members()) {
      const auto same = [&name = name](const ConfigKey* key) { return key->name == name; };
      const auto place = std::find_if(keys.begin(), keys.end(), same);
      if (place == keys.end()) {
        refuse_other_dimension(pointer_to(pointer, name), found, path, name);
        refuse_unknown_key(pointer, name, variant, keys);
      }
      if ((*place)->type == KeyType::unavailable) {
        throw InputError(pointer_to(pointer, name) +
                         ": not available in this version; allowed here: " + name_list(keys));
      }
    }
  }

  /// A key that domains of another dimension have deserves more than "unknown key".
  void refuse_other_dimension(const std::string& pointer, const Json& found, std::string_view path,
                              const std::string& name) const {
    for (const ConfigKey& key : config_keys()) {
      if (key.section != path || key.name != name || key.dimension == 0) continue;
      refuse(pointer, shown(found),
             key.dimension == 2 ? "only in 2D, that is with 2 entries in domain.elements"
                                : "only in 3D, that is with 3 entries in domain.elements");
    }
  }

  /// Adds the checked value of a key, or its default, to `result`.
  void add(Json& result, const ConfigKey& key, const Json* given, const std::string& parent) const {
    const std::string name(key.name), pointer = pointer_to(parent, name);
    if (given != nullptr) {
      result.set(name, checked(key, *given, pointer));
      return;
    }
    if (key.required) throw InputError(pointer + ": missing; allowed: " + allowed_values(key, dimension_));
    const bool other = dimension_ == 2 && !key.default_2d.empty();
    const std::string text(other ? key.default_2d : key.default_value);
    if (!text.empty()) result.set(name, checked(key, Json::parse(text, "default of " + name), pointer));
  }

  Json checked(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (key.type != KeyType::choice && has_word(key.words, value)) return value;
    switch (key.type) {
      case KeyType::flag:
        return flag(key, value, pointer);
      case KeyType::integer:
        return integer(key, value, pointer);
      case KeyType::number:
        if (!is_number_in_range(key, value)) refuse_value(key, value, pointer);
        return value;
      case KeyType::text:
        if (!value.is_string() || value.string().empty()) refuse_value(key, value, pointer);
        return value;
      case KeyType::path:
        return path(key, value, pointer);
      case KeyType::choice:
        return choice(key, value, pointer);
      case KeyType::axis:
      case KeyType::face:
        return named_direction(key, value, pointer);
      case KeyType::vector:
      case KeyType::integer_vector:
      case KeyType::bounds:
      case KeyType::strain:
        return numbers(key, value, pointer);
      case KeyType::points:
        return points(key, value, pointer);
      case KeyType::shapes:
        return shape_list(key, value, pointer);
      case KeyType::section:
        return section(value, pointer, subsection(key));
      case KeyType::sections:
        return section_list(key, value, pointer);
      case KeyType::part:
        return shape(value, pointer, "part");
      case KeyType::node_sets:
        return node_set_map(key, value, pointer);
      case KeyType::unavailable:
        break;
    }
    return value;
  }

  [[noreturn]] void refuse_value(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    std::string allowed = allowed_values(key, dimension_);
    if (key.type == KeyType::vector) allowed += " (as many as domain.elements)";
    if (key.type == KeyType::integer && std::isinf(Interval::parse(key.range).high))
      allowed += ", at most 2147483647";
    refuse(pointer, shown(value), allowed);
  }

  [[noreturn]] void refuse_later(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    refuse_unavailable(pointer, shown(value), allowed_values(key, dimension_));
  }

  Json flag(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!value.is_boolean()) refuse_value(key, value, pointer);
    if (!key.later.empty() && value.boolean()) refuse_later(key, value, pointer);
    return value;
  }

  static bool is_number_in_range(const ConfigKey& key, const Json& value) {
    if (!value.is_number() || !std::isfinite(value.number())) return false;
    return Interval::parse(key.range).contains(value.number());
  }

  static bool is_integer_in_range(const ConfigKey& key, const Json& value) {
    return is_number_in_range(key, value) && std::floor(value.number()) == value.number() &&
           std::abs(value.number()) <= std::numeric_limits<int>::max();
  }

  Json integer(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!is_integer_in_range(key, value)) refuse_value(key, value, pointer);
    if (!key.later.empty() && value.number() != 0.0) refuse_later(key, value, pointer);
    return static_cast<std::int64_t>(value.number());  // 1e3 is an integer, too
  }

  Json path(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!value.is_string() || value.string().empty()) refuse_value(key, value, pointer);
    const std::filesystem::path full = std::filesystem::path(directory_) / value.string();
    std::error_code error;
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(full, error);
    return error ? full.lexically_normal().string() : canonical.string();
  }

  Json choice(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (has_word(key.words, value)) return value;
    if (has_word(key.later, value)) refuse_later(key, value, pointer);
    refuse_value(key, value, pointer);
  }

  Json named_direction(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    const std::size_t length = key.type == KeyType::axis ? 1 : 2;
    const bool valid = value.is_string() && value.string().size() == length && value.string()[0] >= 'x' &&
                       value.string()[0] < 'x' + dimension_ &&
                       (length == 1 || value.string()[1] == '-' || value.string()[1] == '+');
    if (!valid) refuse_value(key, value, pointer);
    return value;
  }

  std::size_t entries(const ConfigKey& key) const {
    if (key.type == KeyType::bounds) return 2;
    if (key.type == KeyType::strain) return dimension_ == 2 ? 3 : 6;
    return static_cast<std::size_t>(dimension_);
  }

  Json numbers(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (key.type == KeyType::strain && value.is_object()) {
      for (const std::string& word : split(key.later, ' ')) {
        if (value.find(word) != nullptr) refuse_later(key, value, pointer);
      }
    }
    if (!value.is_array() || value.items().size() != entries(key)) refuse_value(key, value, pointer);
    Json result = Json::array();
    for (std::size_t i = 0; i < value.items().size(); ++i) {
      const Json& item = value.items()[i];
      const bool integers = key.type == KeyType::integer_vector;
      const bool valid = integers ? is_integer_in_range(key, item) : is_number_in_range(key, item);
      if (!valid) refuse_value(key, item, pointer_to(pointer, i));
      result.append(integers ? Json(static_cast<std::int64_t>(item.number())) : item);
    }
    const bool ascending =
        key.type != KeyType::bounds || value.items()[0].number() < value.items()[1].number();
    if (!ascending) refuse_value(key, value, pointer);
    return result;
  }

  Json points(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!value.is_array() || value.items().size() < 3) refuse_value(key, value, pointer);
    for (std::size_t i = 0; i < value.items().size(); ++i) {
      const Json& item = value.items()[i];
      const bool valid = item.is_array() && item.items().size() == 2 &&
                         is_number_in_range(key, item.items()[0]) && is_number_in_range(key, item.items()[1]);
      if (!valid) refuse(pointer_to(pointer, i), shown(item), "a list of 2 numbers");
    }
    return value;
  }

  Json shape_list(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!value.is_array() || value.items().empty()) refuse_value(key, value, pointer);
    Json result = Json::array();
    for (std::size_t i = 0; i < value.items().size(); ++i) {
      result.append(shape(value.items()[i], pointer_to(pointer, i), ""));
    }
    return result;
  }

  Json section_list(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!value.is_array()) refuse_value(key, value, pointer);
    Json result = Json::array();
    for (std::size_t i = 0; i < value.items().size(); ++i) {
      result.append(section(value.items()[i], pointer_to(pointer, i), subsection(key)));
    }
    return result;
  }

  Json node_set_map(const ConfigKey& key, const Json& value, const std::string& pointer) const {
    if (!value.is_object()) refuse_value(key, value, pointer);
    Json result = Json::object();
    for (const auto& [name, member] : value.members()) {
      result.set(name, shape(member, pointer_to(pointer, name), "node_sets.NAME"));
    }
    return result;
  }

  /// An object with exactly one shape (or voxels) and the further keys of the section `extra`.
  Json shape(const Json& value, const std::string& pointer, const std::string& extra) const {
    Keys keys = keys_of("shape", ""), sources, given;
    if (!extra.empty()) {
      for (const ConfigKey* key : keys_of(extra, "")) keys.push_back(key);
    }
    const auto is_source = [](const ConfigKey* key) {
      return key->type == KeyType::section || key->type == KeyType::shapes;
    };
    std::copy_if(keys.begin(), keys.end(), std::back_inserter(sources), is_source);
    if (!value.is_object()) refuse(pointer, shown(value), "an object with one of " + name_list(sources));
    refuse_strangers(value, pointer, "shape", "", keys);
    const auto is_given = [&](const ConfigKey* key) { return value.find(std::string(key->name)) != nullptr; };
    std::copy_if(sources.begin(), sources.end(), std::back_inserter(given), is_given);
    if (given.size() != 1) {
      refuse(pointer, given.empty() ? "no shape" : name_list(given), "exactly one of " + name_list(sources));
    }
    Json result = Json::object();
    for (const ConfigKey* key : keys) {
      if (!is_source(key) || key == given.front())
        add(result, *key, value.find(std::string(key->name)), pointer);
    }
    return result;
  }

  int dimension_;
  std::string directory_;
};

/// The entries of domain.elements decide; what else may be wrong with them is found later.
int find_dimension(const Json& document) {
  const Json* domain = document.find("domain");
  const Json* elements = domain != nullptr ? domain->find("elements") : nullptr;
  if (elements == nullptr) return 3;
  const bool valid = elements->is_array() && (elements->items().size() == 2 || elements->items().size() == 3);
  if (!valid) refuse("/domain/elements", shown(*elements), "a list of 2 or 3 integers >= 1");
  return static_cast<int>(elements->items().size());
}

}  // namespace

Json complete_config(const Json& document, const std::string& directory) {
  if (!document.is_object()) refuse("", shown(document), "an object");
  Json input = Json::object();
  for (const auto& [name, value] : document.members()) {
    if (name != "run") input.set(name, value);  // a record of the run that wrote the file
  }
  return Completion(find_dimension(input), directory).section(input, "", "");
}

}  // namespace fabseq
