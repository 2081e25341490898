// SPDX-License-Identifier: MIT
#include "fabseq/base/json.h"

#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

/// Deeper documents are refused. Nothing that fabseq reads needs them, and the limit bounds every recursion
/// over a document.
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

/// Builds a value from the parser's events, which show duplicate keys and the depth of nesting.
class Builder : public nlohmann::json_sax<Json> {
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
    if (open_.back()->contains(name))
      throw InputError(place_ + ": key " + to_text(name) + " is given twice in the same object");
    key_ = name;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    const Json message = Json::parse(to_text(bare_message(error.what())));  // what is not UTF-8 is replaced
    throw InputError(place_ + ": " + place_in_text(text_, position) + ": " + message.get<std::string>());
  }

 private:
  bool add(Json value) {
    insert(std::move(value));
    return true;
  }

  bool open(Json container) {
    if (open_.size() >= max_depth)
      throw InputError(place_ + ": nested more than " + std::to_string(max_depth) + " levels deep");
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
      parent.push_back(std::move(value));
      return parent.back();
    }
    return parent[key_] = std::move(value);
  }

  const std::string& text_;
  const std::string& place_;
  Json root_;
  std::vector<Json*> open_;
  std::string key_;
};

void write(std::string& text, const Json& value, int indent, int level) {
  if (!value.is_structured() || value.empty()) {
    text += value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const auto is_structured = [](const Json& item) { return item.is_structured(); };
  const bool lines =
      indent >= 0 && (value.is_object() || std::any_of(value.begin(), value.end(), is_structured));
  const auto new_line = [&](int at) {
    if (lines) text.append("\n").append(static_cast<std::size_t>(indent) * static_cast<std::size_t>(at), ' ');
  };
  text += value.is_object() ? '{' : '[';
  const char* separator = "";
  for (auto item = value.begin(); item != value.end(); ++item) {
    text += separator;
    separator = lines || indent < 0 ? "," : ", ";
    new_line(level + 1);
    if (value.is_object()) text += to_text(item.key()) + (indent < 0 ? ":" : ": ");
    write(text, *item, indent, level + 1);
  }
  new_line(level);
  text += value.is_object() ? '}' : ']';
}

}  // namespace

Json parse_json(const std::string& text, const std::string& place) {
  constexpr bool whole_text = true, allow_comments = true;
  const PlainNumbers plain;  // nlohmann reads them by strtod()
  Builder builder(text, place);
  Json::sax_parse(text, &builder, nlohmann::json::input_format_t::json, whole_text, allow_comments);
  return builder.take();
}

std::string to_text(const Json& value, int indent) {
  std::string text;
  write(text, value, indent, 0);
  return text;
}

const Json* find_member(const Json& value, const std::string& key) {
  const auto found = value.find(key);
  return found == value.end() ? nullptr : &*found;
}

Json* find_member(Json& value, const std::string& key) {
  return const_cast<Json*>(find_member(std::as_const(value), key));
}

const Json* find_member(const Json& value, const std::string& key, const std::string& inner_key) {
  const Json* outer = find_member(value, key);
  return outer == nullptr ? nullptr : find_member(*outer, inner_key);
}

}  // namespace fabseq
