// SPDX-License-Identifier: MIT
/// \file
/// A JSON value. Keeps the JSON library's header, which is slow to compile, in one source file.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace fabseq {

/// null, boolean, integer, number, string, array, or object (members in the order they were added).
class Json {
 public:
  using Array = std::vector<Json>;
  using Member = std::pair<std::string, Json>;
  using Object = std::vector<Member>;

  Json() = default;
  Json(bool value) : value_(value) {}                            // NOLINT(google-explicit-constructor)
  Json(int value) : value_(static_cast<std::int64_t>(value)) {}  // NOLINT(google-explicit-constructor)
  Json(std::int64_t value) : value_(value) {}                    // NOLINT(google-explicit-constructor)
  Json(double value) : value_(value) {}                          // NOLINT(google-explicit-constructor)
  Json(const char* value) : value_(std::string(value)) {}        // NOLINT(google-explicit-constructor)
  Json(std::string value) : value_(std::move(value)) {}          // NOLINT(google-explicit-constructor)
  Json(Array value) : value_(std::move(value)) {}                // NOLINT(google-explicit-constructor)
  Json(const std::vector<double>& values);                       // NOLINT(google-explicit-constructor)
  Json(const std::vector<int>& values);                          // NOLINT(google-explicit-constructor)
  static Json object(std::initializer_list<Member> members = {});
  static Json array() { return Json(Array{}); }

  /// Parses JSON with // and /* */ comments. Throws InputError ("PLACE: line L, column C: ...") on malformed
  /// text, and for a key given twice in the same object.
  static Json parse(const std::string& text, const std::string& place);
  /// Text of this value; numbers survive a round trip bit for bit; NaN and infinity become null. indent < 0:
  /// one line.
  std::string dump(int indent = -1) const;

  bool is_null() const { return std::holds_alternative<std::monostate>(value_); }
  bool is_boolean() const { return std::holds_alternative<bool>(value_); }
  bool is_integer() const { return std::holds_alternative<std::int64_t>(value_); }
  bool is_number() const { return is_integer() || std::holds_alternative<double>(value_); }
  bool is_string() const { return std::holds_alternative<std::string>(value_); }
  bool is_array() const { return std::holds_alternative<Array>(value_); }
  bool is_object() const { return std::holds_alternative<Object>(value_); }

  /// Access with the type known; std::bad_variant_access otherwise.
  bool boolean() const { return std::get<bool>(value_); }
  std::int64_t integer() const { return std::get<std::int64_t>(value_); }
  double number() const { return is_integer() ? static_cast<double>(integer()) : std::get<double>(value_); }
  const std::string& string() const { return std::get<std::string>(value_); }
  const Array& items() const { return std::get<Array>(value_); }
  Array& items() { return std::get<Array>(value_); }
  const Object& members() const { return std::get<Object>(value_); }
  Object& members() { return std::get<Object>(value_); }
  std::vector<double> numbers() const;

  /// Member of an object, nullptr where there is none (or this is no object).
  const Json* find(const std::string& key) const;
  Json* find(const std::string& key);
  /// Member of an object that must be there; std::out_of_range otherwise.
  const Json& at(const std::string& key) const;
  /// Sets or appends a member of an object (null becomes an empty object) and returns that member.
  Json& set(const std::string& key, Json value);
  /// Appends to an array (null becomes an empty array).
  void append(Json value);

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Object> value_;
};

}  // namespace fabseq
