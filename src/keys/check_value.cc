// SPDX-License-Identifier: MIT
#include "fabseq/keys/check_value.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>

namespace fabseq {

namespace {

bool has_word(std::string_view words, const Json& value) {
  if (!value.is_string()) return false;
  const std::vector<std::string> list = split(words, ' ');
  return std::find(list.begin(), list.end(), value.get<std::string>()) != list.end();
}

/// The values that the key takes, with what the domain or the type of the member adds.
std::string allowed_here(const ConfigKey& key, const ValueContext& context) {
  std::string allowed = allowed_values(key, context.dimension);
  if (key.type == KeyType::vector) allowed += " (as many as domain.elements)";
  if (key.type == KeyType::integer && std::isinf(Interval::parse(key.range).high))
    allowed += ", at most 2147483647";
  return allowed;
}

/// Checks one value against its key.
class ValueCheck {
 public:
  ValueCheck(const ConfigKey& key, const Json& value, const std::string& pointer, const ValueContext& context)
      : key_(key), value_(value), pointer_(pointer), context_(context) {}

  Json checked() const {
    if (key_.type != KeyType::choice && has_word(key_.words, value_)) return value_;
    switch (key_.type) {
      case KeyType::flag:
        return required(value_.is_boolean());
      case KeyType::integer:
        return as_integer(required(is_integer_in_range(value_)));
      case KeyType::number:
        return required(is_number_in_range(value_));
      case KeyType::text:
        return required(is_text());
      case KeyType::path:
        return path();
      case KeyType::choice:
        return required(has_word(key_.words, value_));
      case KeyType::axis:
        return required(is_direction(value_, 1));
      case KeyType::face:
        return required(is_direction(value_, 2) &&
                        (value_.get<std::string>()[1] == '-' || value_.get<std::string>()[1] == '+'));
      case KeyType::vector:
      case KeyType::integer_vector:
      case KeyType::bounds:
        return numbers();
      case KeyType::strain:
        return value_.is_object() ? turning_strain() : numbers();
      case KeyType::points:
        required(value_.is_array() && value_.size() >= 3);
        return lists_of(2);
      case KeyType::profile:
        return profile();
      case KeyType::list:
        return entries_that([&](const Json& item) { return is_number_in_range(item); }, allowed());
      case KeyType::vectors:
        return lists_of(context_.dimension);
      case KeyType::lengths:
        return value_.is_array() ? numbers() : required(is_number_in_range(value_));
      case KeyType::turns:
        return entries_that([&](const Json& item) { return is_turn(item); }, allowed());
      case KeyType::angles:
        return lists_of(context_.dimension - 1);
      case KeyType::angle_bounds:
        return angle_bounds();
      case KeyType::word_list:
        return entries_that([&](const Json& item) { return has_word(key_.words, item); },
                            join(split(key_.words, ' '), ", "));
      case KeyType::starts:
        return required(value_.is_array());
      case KeyType::shape:
        refuse_found();  // a word that the key does not take
      default:
        return value_;  // objects and lists of objects are checked key by key
    }
  }

 private:
  std::string allowed() const { return allowed_here(key_, context_); }
  [[noreturn]] void refuse_found() const { refuse_value(key_, value_, pointer_, context_); }
  const Json& required(bool valid) const {
    if (!valid) refuse_found();
    return value_;
  }

  /// The list, of which the first entry that does not pass is refused.
  template <class Passes>
  const Json& entries_that(const Passes& passes, const std::string& allowed) const {
    required(value_.is_array());
    for (std::size_t i = 0; i < value_.size(); ++i)
      if (!passes(value_[i])) refuse(pointer_to(pointer_, i), shown(value_[i]), allowed);
    return value_;
  }

  bool is_text() const { return value_.is_string() && !value_.get<std::string>().empty(); }

  bool is_number_in_range(const Json& value) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return false;
    return Interval::parse(key_.range).contains(value.get<double>());
  }

  bool is_integer_in_range(const Json& value) const {
    return is_number_in_range(value) && std::floor(value.get<double>()) == value.get<double>() &&
           std::abs(value.get<double>()) <= std::numeric_limits<int>::max();
  }

  /// 1e3 counts as an integer.
  static Json as_integer(const Json& value) { return static_cast<std::int64_t>(value.get<double>()); }

  bool are_numbers(const Json& value, int count) const {
    return value.is_array() && value.size() == static_cast<std::size_t>(count) &&
           std::all_of(value.begin(), value.end(),
                       [&](const Json& item) { return is_number_in_range(item); });
  }

  /// Whether the value is a string of `length` characters that begins with the name of an axis.
  bool is_direction(const Json& value, std::size_t length) const {
    return value.is_string() && value.get<std::string>().size() == length &&
           value.get<std::string>()[0] >= 'x' && value.get<std::string>()[0] < 'x' + context_.dimension;
  }

  bool is_turn(const Json& value) const {
    if (!value.is_array() || value.size() != 2 || !is_number_in_range(value[1])) return false;
    const Json& axis = value[0];
    const auto is_zero = [](const Json& entry) { return entry.get<double>() == 0.0; };
    return is_direction(axis, 1) ||
           (are_numbers(axis, context_.dimension) && !std::all_of(axis.begin(), axis.end(), is_zero));
  }

  static bool is_ascending(const Json& pair) { return pair[0].get<double>() < pair[1].get<double>(); }

  Json path() const {
    required(is_text());
    const std::filesystem::path full = std::filesystem::path(context_.directory) / value_.get<std::string>();
    std::error_code error;
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(full, error);
    return error ? full.lexically_normal().string() : canonical.string();
  }

  std::size_t entries() const {
    if (key_.type == KeyType::bounds) return 2;
    if (key_.type == KeyType::strain) return context_.dimension == 2 ? 3 : 6;
    return static_cast<std::size_t>(context_.dimension);
  }

  Json numbers() const {
    required(value_.is_array() && value_.size() == entries());
    const bool integers = key_.type == KeyType::integer_vector;
    Json result = entries_that(
        [&](const Json& item) { return integers ? is_integer_in_range(item) : is_number_in_range(item); },
        allowed());
    if (integers) std::transform(result.begin(), result.end(), result.begin(), as_integer);
    required(key_.type != KeyType::bounds || is_ascending(value_));
    return result;
  }

  /// An inherent strain along (tangential) and across (normal) the layers.
  Json turning_strain() const {
    const char* const names[] = {"tangential", "normal"};
    required(value_.size() == std::size(names));
    for (const char* name : names) {
      const Json* member = find_member(value_, name);
      required(member != nullptr);
      if (!is_number_in_range(*member)) refuse(pointer_to(pointer_, name), shown(*member), "a number");
    }
    return value_;
  }

  Json lists_of(int count) const {
    return entries_that([&](const Json& item) { return are_numbers(item, count); },
                        "a list of " + std::to_string(count) + (count == 1 ? " number" : " numbers") +
                            Interval::parse(key_.range).text());
  }

  Json angle_bounds() const {
    required(value_.is_array() && !value_.empty());
    if (value_[0].is_number()) return required(are_numbers(value_, 2) && is_ascending(value_));
    lists_of(2);
    return entries_that(is_ascending, "two ascending numbers");
  }

  Json profile() const {
    required(value_.is_array() && value_.size() != 1);
    double lowest = -std::numeric_limits<double>::infinity();
    const auto follows = [&](const Json& item) {
      if (!are_numbers(item, 2) || item[1].get<double>() < 0.0 || item[0].get<double>() < lowest)
        return false;
      lowest = item[0].get<double>();
      return true;
    };
    return entries_that(follows, allowed());
  }

  const ConfigKey& key_;
  const Json& value_;
  const std::string& pointer_;
  const ValueContext& context_;
};

}  // namespace

void refuse_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                  const ValueContext& context) {
  refuse(pointer, shown(value), allowed_here(key, context));
}

Json checked_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                   const ValueContext& context) {
  return ValueCheck(key, value, pointer, context).checked();
}

}  // namespace fabseq
