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

/// Checks one value against its key.
class ValueCheck {
 public:
  ValueCheck(const ConfigKey& key, const Json& value, const std::string& pointer, const ValueContext& context)
      : key_(key), value_(value), pointer_(pointer), context_(context) {}

  Json checked() const {
    if (key_.type != KeyType::choice && has_word(key_.words, value_)) return value_;
    switch (key_.type) {
      case KeyType::flag:
        return flag();
      case KeyType::integer:
        return integer();
      case KeyType::number:
        return required(is_number_in_range(value_));
      case KeyType::text:
        return required(is_text());
      case KeyType::path:
        return path();
      case KeyType::choice:
        return choice();
      case KeyType::axis:
        return required(is_direction(1));
      case KeyType::face:
        return required(is_direction(2) &&
                        (value_.get<std::string>()[1] == '-' || value_.get<std::string>()[1] == '+'));
      case KeyType::vector:
      case KeyType::integer_vector:
      case KeyType::bounds:
        return numbers();
      case KeyType::strain:
        return value_.is_object() ? turning_strain() : numbers();
      case KeyType::points:
        return points();
      case KeyType::profile:
        return profile();
      case KeyType::list:
        return list();
      case KeyType::vectors:
        return lists_of(context_.dimension);
      case KeyType::lengths:
        return value_.is_array() ? numbers() : required(is_number_in_range(value_));
      case KeyType::turns:
        return turns();
      case KeyType::angles:
        return lists_of(context_.dimension - 1);
      case KeyType::angle_bounds:
        return angle_bounds();
      case KeyType::word_list:
        return word_list();
      case KeyType::shape:
        refuse_found();  // a word that the key does not take
      default:
        return value_;  // objects and lists of objects are checked key by key
    }
  }

 private:
  [[noreturn]] void refuse_found() const { refuse_value(key_, value_, pointer_, context_); }
  Json required(bool valid) const {
    if (!valid) refuse_found();
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

  /// Whether the value is a string of `length` characters that begins with the name of an axis.
  bool is_direction(std::size_t length) const { return is_direction(value_, length); }
  bool is_direction(const Json& value, std::size_t length) const {
    return value.is_string() && value.get<std::string>().size() == length &&
           value.get<std::string>()[0] >= 'x' && value.get<std::string>()[0] < 'x' + context_.dimension;
  }

  Json flag() const {
    if (!value_.is_boolean()) refuse_found();
    return value_;
  }

  Json integer() const {
    if (!is_integer_in_range(value_)) refuse_found();
    return static_cast<std::int64_t>(value_.get<double>());  // 1e3 counts as an integer
  }

  Json path() const {
    if (!is_text()) refuse_found();
    const std::filesystem::path full = std::filesystem::path(context_.directory) / value_.get<std::string>();
    std::error_code error;
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(full, error);
    return error ? full.lexically_normal().string() : canonical.string();
  }

  Json choice() const { return required(has_word(key_.words, value_)); }

  std::size_t entries() const {
    if (key_.type == KeyType::bounds) return 2;
    if (key_.type == KeyType::strain) return context_.dimension == 2 ? 3 : 6;
    return static_cast<std::size_t>(context_.dimension);
  }

  Json numbers() const {
    if (!value_.is_array() || value_.size() != entries()) refuse_found();
    Json result = Json::array();
    for (std::size_t i = 0; i < value_.size(); ++i) {
      const Json& item = value_[i];
      const bool integers = key_.type == KeyType::integer_vector;
      const bool valid = integers ? is_integer_in_range(item) : is_number_in_range(item);
      if (!valid) refuse_value(key_, item, pointer_to(pointer_, i), context_);
      result.push_back(integers ? Json(static_cast<std::int64_t>(item.get<double>())) : item);
    }
    const bool ascending = key_.type != KeyType::bounds || value_[0].get<double>() < value_[1].get<double>();
    if (!ascending) refuse_found();
    return result;
  }

  /// An inherent strain along (tangential) and across (normal) the layers.
  Json turning_strain() const {
    const char* const names[] = {"tangential", "normal"};
    if (value_.size() != std::size(names)) refuse_found();
    for (const char* name : names) {
      const Json* member = find_member(value_, name);
      if (member == nullptr) refuse_found();
      if (!is_number_in_range(*member))
        refuse(pointer_to(pointer_, std::string(name)), shown(*member), "a number");
    }
    return value_;
  }

  Json list() const {
    if (!value_.is_array()) refuse_found();
    for (std::size_t i = 0; i < value_.size(); ++i)
      if (!is_number_in_range(value_[i])) refuse_value(key_, value_[i], pointer_to(pointer_, i), context_);
    return value_;
  }

  /// Refuses an entry that is not a list of `count` numbers.
  void require_numbers(std::size_t entry, std::size_t count) const {
    const Json& item = value_[entry];
    bool valid = item.is_array() && item.size() == count;
    for (std::size_t i = 0; valid && i < count; ++i) valid = is_number_in_range(item[i]);
    if (!valid)
      refuse(pointer_to(pointer_, entry), shown(item),
             "a list of " + std::to_string(count) + (count == 1 ? " number" : " numbers") +
                 Interval::parse(key_.range).text());
  }

  Json lists_of(int numbers) const {
    if (!value_.is_array()) refuse_found();
    for (std::size_t i = 0; i < value_.size(); ++i) require_numbers(i, static_cast<std::size_t>(numbers));
    return value_;
  }

  Json turns() const {
    if (!value_.is_array()) refuse_found();
    for (std::size_t i = 0; i < value_.size(); ++i) {
      const Json& turn = value_[i];
      if (!turn.is_array() || turn.size() != 2 || !is_number_in_range(turn[1]) ||
          !(is_direction(turn[0], 1) || is_vector_other_than_zero(turn[0])))
        refuse_value(key_, turn, pointer_to(pointer_, i), context_);
    }
    return value_;
  }

  bool is_vector_other_than_zero(const Json& value) const {
    const auto is_number = [&](const Json& entry) { return is_number_in_range(entry); };
    const auto is_zero = [](const Json& entry) { return entry.get<double>() == 0.0; };
    return value.is_array() && value.size() == static_cast<std::size_t>(context_.dimension) &&
           std::all_of(value.begin(), value.end(), is_number) &&
           !std::all_of(value.begin(), value.end(), is_zero);
  }

  Json angle_bounds() const {
    if (!value_.is_array() || value_.empty()) refuse_found();
    const auto is_ascending = [](const Json& pair) { return pair[0].get<double>() < pair[1].get<double>(); };
    const Json& items = value_;
    if (items[0].is_number())
      return required(items.size() == 2 && is_number_in_range(items[0]) && is_number_in_range(items[1]) &&
                      is_ascending(value_));
    for (std::size_t i = 0; i < items.size(); ++i) {
      require_numbers(i, 2);
      if (!is_ascending(items[i])) refuse(pointer_to(pointer_, i), shown(items[i]), "two ascending numbers");
    }
    return value_;
  }

  Json word_list() const {
    if (!value_.is_array()) refuse_found();
    for (std::size_t i = 0; i < value_.size(); ++i)
      if (!has_word(key_.words, value_[i]))
        refuse(pointer_to(pointer_, i), shown(value_[i]), join(split(key_.words, ' '), ", "));
    return value_;
  }

  Json points() const {
    if (!value_.is_array() || value_.size() < 3) refuse_found();
    for (std::size_t i = 0; i < value_.size(); ++i) {
      const Json& item = value_[i];
      const bool valid =
          item.is_array() && item.size() == 2 && is_number_in_range(item[0]) && is_number_in_range(item[1]);
      if (!valid) refuse(pointer_to(pointer_, i), shown(item), "a list of 2 numbers");
    }
    return value_;
  }

  Json profile() const {
    if (!value_.is_array() || value_.size() == 1) refuse_found();
    for (std::size_t i = 0; i < value_.size(); ++i) {
      const auto is_pair = [&](const Json& item) {
        return item.is_array() && item.size() == 2 && is_number_in_range(item[0]) &&
               is_number_in_range(item[1]) && item[1].get<double>() >= 0.0;
      };
      if (!is_pair(value_[i]) || (i > 0 && value_[i][0].get<double>() < value_[i - 1][0].get<double>()))
        refuse_value(key_, value_[i], pointer_to(pointer_, i), context_);
    }
    return value_;
  }

  const ConfigKey& key_;
  const Json& value_;
  const std::string& pointer_;
  const ValueContext& context_;
};

}  // namespace

void refuse_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                  const ValueContext& context) {
  std::string allowed = allowed_values(key, context.dimension);
  if (key.type == KeyType::vector) allowed += " (as many as domain.elements)";
  if (key.type == KeyType::integer && std::isinf(Interval::parse(key.range).high))
    allowed += ", at most 2147483647";
  refuse(pointer, shown(value), allowed);
}

Json checked_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                   const ValueContext& context) {
  return ValueCheck(key, value, pointer, context).checked();
}

}  // namespace fabseq
