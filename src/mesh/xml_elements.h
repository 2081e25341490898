// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string_view>

namespace fabseq {

/// The attributes of an element of XML. Refers to the parser's memory.
class XmlAttributes {
 public:
  /// `pairs`: names and values by turns, and a null pointer.
  explicit XmlAttributes(const char* const* pairs) : pairs_(pairs) {}

  /// The value of the attribute with this name, whatever its prefix; empty if there is none.
  std::string_view operator[](std::string_view name) const;
  /// The value of the attribute that has this name with its prefix, such as "xmlns:p".
  std::string_view exactly(std::string_view name) const;

 private:
  const char* const* pairs_;
};

/// Calls f(name, attributes) for the elements of a text, in their order, each without the prefix of its name.
/// Through expat. Throws InputError with the line if the text is not well-formed; passes on what f throws.
void for_each_xml_element(std::string_view text,
                          const std::function<void(std::string_view, const XmlAttributes&)>& f);

}  // namespace fabseq
