// SPDX-License-Identifier: MIT
/// \file
/// JSON values, and how fabseq reads and writes them.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace fabseq {

/// A JSON value; members of an object stay in the order in which they were added.
using Json = nlohmann::ordered_json;

/// Parses JSON with // and /* */ comments. Throws InputError ("PLACE: line L, column C: ...") for malformed
/// text, for a key that an object has twice, and for a document that is nested too deeply.
Json parse_json(const std::string& text, const std::string& place);
/// Text of a value. Numbers survive a round trip bit for bit; NaN and infinity become null. A negative
/// `indent` gives one line. With an indent, lists of plain values stay on one line, so that vectors read as
/// vectors.
std::string to_text(const Json& value, int indent = -1);

/// Member of an object; nullptr if there is none or if `value` is no object.
const Json* find_member(const Json& value, const std::string& key);
Json* find_member(Json& value, const std::string& key);
/// The same for a member of a member.
const Json* find_member(const Json& value, const std::string& key, const std::string& inner_key);

}  // namespace fabseq
