// SPDX-License-Identifier: MIT
#include "fabseq/base/json.h"

#include "fabseq/base/error.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace fabseq {

namespace {

/// Deeper documents are refused: nothing fabseq reads needs it, and it bounds every recursion over a
/// document.
constexpr std::size_t max_depth = 64;

std::string place_in_text(const std::string& text, std::size_t position) {
  const std::size_t end = std::min(position > 0 ? position - 1 : 0, text.size());
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n') + 1;
  const std::size_t line_break = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  const std::size_t column = line_break == std::string::npos ? end + 1 : end - line_break;
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// nlohmann's message without its identifier and its own account of the place.
std::string bare_message(const std::string& message) {
  std::size_t start = message.find("] ");
  start = start == std::string::npos ? 0 : start + 2;
  const std::size_t column = message.find("column ", start);
  const std::size_t colon = column == std::string::npos ? column : message.find(": ", column);
  return message.substr(colon == std::string::npos ? start : colon + 2);
}

/// Builds a Json from the parser's events, so that member order is kept and double keys are seen.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(const std::string& text, const std::string& place) : text_(text), place_(place) {}
  Json take() { return std::move(root_); }

  bool null() override { return add(Json()); }
  bool boolean(bool value) override { return add(Json(value)); }
  bool number_integer(number_integer_t value) override { return add(Json(static_cast<std::int64_t>(value))); }
  bool number_unsigned(number_unsigned_t value) override {
    const bool fits = value <= static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max());
    return add(fits ? Json(static_cast<std::int64_t>(value)) : Json(static_cast<double>(value)));
  }
  bool number_float(number_float_t value, const string_t&) override { return add(Json(value)); }
  bool string(string_t& value) override { return add(Json(std::move(value))); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    if (open_.back()->find(name) != nullptr) {
      throw InputError(place_ + ": key " + Json(name).dump() + " is given twice in the same object");
    }
    key_ = name;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    throw InputError(place_ + ": " + place_in_text(text_, position) + ": " + bare_message(error.what()));
  }

 private:
  bool add(Json value) {
    insert(std::move(value));
    return true;
  }

  bool open(Json container) {
    if (open_.size() >= max_depth) {
      throw InputError(place_ + ": nested more than " + std::to_string(max_depth) + " levels deep");
    }
    open_.push_back(&insert(std::move(container)));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  // Pointers in open_ stay valid: only the innermost open container grows.
  Json& insert(Json value) {
    if (open_.empty()) return root_ = std::move(value);
    Json& parent = *open_.back();
    if (parent.is_array()) {
      parent.append(std::move(value));
      return parent.items().back();
    }
    parent.members().emplace_back(key_, std::move(value));
    return parent.members().back().second;
  }

  const std::string& text_;
  const std::string& place_;
  Json root_;
  std::vector<Json*> open_;
  std::string key_;
};

std::string quote(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool is_container(const Json& value) { return value.is_array() || value.is_object(); }

class Writer {
 public:
  explicit Writer(int indent) : indent_(indent) {}

  void write(const Json& value, int level) {
    if (value.is_object()) {
      write_object(value.members(), level);
    } else if (value.is_array()) {
      write_array(value.items(), level);
    } else {
      write_scalar(value);
    }
  }
  std::string take() { return std::move(text_); }

 private:
  void write_scalar(const Json& value) {
    if (value.is_null()) {
      text_ += "null";
    } else if (value.is_boolean()) {
      text_ += value.boolean() ? "true" : "false";
    } else if (value.is_string()) {
      text_ += quote(value.string());
    } else if (value.is_integer()) {
      text_ += std::to_string(value.integer());
    } else {
      text_ += nlohmann::json(value.number()).dump();  // shortest text that reads back to the same number
    }
  }

  void write_object(const Json::Object& members, int level) {
    text_ += '{';
    bool first = true;
    for (const auto& [name, value] : members) {
      if (!first) text_ += ',';
      first = false;
      new_line(level + 1);
      text_ += quote(name) + (indent_ < 0 ? ":" : ": ");
      write(value, level + 1);
    }
    if (!members.empty()) new_line(level);
    text_ += '}';
  }

  /// Lists of plain values stay on one line, so that vectors read as vectors.
  void write_array(const Json::Array& items, int level) {
    const bool nested = std::any_of(items.begin(), items.end(), is_container);
    text_ += '[';
    bool first = true;
    for (const Json& item : items) {
      if (!first) text_ += nested || indent_ < 0 ? "," : ", ";
      first = false;
      if (nested) new_line(level + 1);
      write(item, level + 1);
    }
    if (nested) new_line(level);
    text_ += ']';
  }

  void new_line(int level) {
    if (indent_ < 0) return;
    text_ += '\n';
    text_.append(static_cast<std::size_t>(indent_) * static_cast<std::size_t>(level), ' ');
  }

  int indent_;
  std::string text_;
};

}  // namespace

Json::Json(const std::vector<double>& values) : value_(Array(values.begin(), values.end())) {}

Json::Json(const std::vector<int>& values) : value_(Array(values.begin(), values.end())) {}

Json Json::object(std::initializer_list<Member> members) {
  Json result;
  result.value_ = Object(members);
  return result;
}

Json Json::parse(const std::string& text, const std::string& place) {
  constexpr bool whole_text = true, allow_comments = true;
  Builder builder(text, place);
  nlohmann::json::sax_parse(text, &builder, nlohmann::json::input_format_t::json, whole_text, allow_comments);
  return builder.take();
}

std::string Json::dump(int indent) const {
  Writer writer(indent);
  writer.write(*this, 0);
  return writer.take();
}

std::vector<double> Json::numbers() const {
  std::vector<double> result;
  result.reserve(items().size());
  for (const Json& item : items()) result.push_back(item.number());
  return result;
}

const Json* Json::find(const std::string& key) const {
  if (!is_object()) return nullptr;
  for (const auto& [name, value] : members()) {
    if (name == key) return &value;
  }
  return nullptr;
}

Json* Json::find(const std::string& key) { return const_cast<Json*>(std::as_const(*this).find(key)); }

const Json& Json::at(const std::string& key) const {
  const Json* member = find(key);
  if (member == nullptr) throw std::out_of_range("no member \"" + key + "\" in " + dump());
  return *member;
}

Json& Json::set(const std::string& key, Json value) {
  if (is_null()) value_ = Object{};
  if (Json* member = find(key)) {
    *member = std::move(value);
    return *member;
  }
  members().emplace_back(key, std::move(value));
  return members().back().second;
}

void Json::append(Json value) {
  if (is_null()) value_ = Array{};
  items().push_back(std::move(value));
}

}  // namespace fabseq
