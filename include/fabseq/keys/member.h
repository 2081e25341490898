// SPDX-License-Identifier: MIT
/// \file
/// What follows for a key from the type of the settings member that it is bound to.
#pragma once

#include "fabseq/keys/config_key.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace fabseq {

template <class Member>
inline constexpr bool is_optional = false;
template <class Value>
inline constexpr bool is_optional<std::optional<Value>> = true;

template <class Member>
inline constexpr bool is_vector = false;
template <class Value>
inline constexpr bool is_vector<std::vector<Value>> = true;

/// Type of the key that is bound to a member. A flag whose key has words is a choice between two of them,
/// false first.
template <class Member>
KeyType type_of(const ConfigKey& key, const Member& /*member*/) {
  if (key.type != KeyType::of_member) return key.type;
  if constexpr (is_optional<Member>) {
    return type_of(ConfigKey{}, typename Member::value_type{});  // the key's words mean "no value"
  } else if constexpr (std::is_same_v<Member, bool>) {
    return key.words.empty() ? KeyType::flag : KeyType::choice;
  } else if constexpr (std::is_enum_v<Member>) {
    return KeyType::choice;
  } else if constexpr (std::is_same_v<Member, int>) {
    return KeyType::integer;
  } else if constexpr (std::is_same_v<Member, double>) {
    return KeyType::number;
  } else if constexpr (std::is_same_v<Member, std::vector<double>>) {
    return KeyType::vector;
  } else if constexpr (std::is_same_v<Member, std::vector<int>>) {
    return KeyType::integer_vector;
  } else {
    return KeyType::text;
  }
}

/// JSON text of a member's value, which is the default of its key; empty if there is none. For optional
/// members without a value and for empty vectors it is the first of the key's words.
template <class Member>
std::string text_of(const ConfigKey& key, const Member& member) {
  const auto word = [&](std::size_t index) {
    const std::vector<std::string> words = split(key.words, ' ');
    return words.empty() ? std::string() : to_text(words.at(index));
  };
  if constexpr (is_optional<Member>) {
    return member ? text_of(key, *member) : word(0);
  } else if constexpr (is_vector<Member>) {
    return member.empty() ? word(0) : to_text(member);
  } else if constexpr (std::is_same_v<Member, std::string>) {
    return member.empty() ? "" : to_text(member);
  } else if constexpr (std::is_same_v<Member, int>) {
    if (key.type != KeyType::axis) return to_text(member);
    return member < 0 ? "" : to_text(std::string(1, static_cast<char>('x' + member)));
  } else {
    if (key.type == KeyType::choice) return word(static_cast<std::size_t>(member));
    if constexpr (std::is_enum_v<Member>) {
      return "";
    } else {
      std::string text = to_text(member);
      const std::size_t exponent = text.find("e-0");
      return exponent == std::string::npos ? text : text.erase(exponent + 2, 1);
    }
  }
}

/// Sets a member to a checked value. The words of a choice stand in the order of the enumerators.
template <class Member>
void read_member(const ConfigKey& key, const Json& value, Member& member) {
  const auto index = [&] {
    const std::vector<std::string> words = split(key.words, ' ');
    return std::find(words.begin(), words.end(), value.get<std::string>()) - words.begin();
  };
  if constexpr (is_optional<Member>) {
    member.reset();
    if (!value.is_string()) read_member(key, value, member.emplace());
  } else if constexpr (is_vector<Member>) {
    member = value.is_array() ? value.get<Member>() : Member{};
  } else if constexpr (std::is_enum_v<Member>) {
    member = static_cast<Member>(index());
  } else if constexpr (std::is_same_v<Member, bool>) {
    member = key.type == KeyType::choice ? index() != 0 : value.get<bool>();
  } else if constexpr (std::is_same_v<Member, int>) {
    member = key.type == KeyType::axis ? value.get<std::string>()[0] - 'x' : value.get<int>();
  } else {
    member = value.get<Member>();
  }
}

/// The reverse of read_member(): puts a member's value into an object that a config has been read from.
/// Leaves alone what says the same, and what is not there where the member has its default `initial`.
template <class Member>
void write_member(const ConfigKey& key, const Member& member, const Member& initial, Json& object) {
  Member before = initial;
  if (const Json* found = find_member(object, key.name)) read_member(key, *found, before);
  if (member == before) return;
  const std::string text = text_of(key, member);
  if (!text.empty()) object[key.name] = parse_json(text, key.name);
}

}  // namespace fabseq
