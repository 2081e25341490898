// SPDX-License-Identifier: MIT
#include "mesh/xml_elements.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <exception>
#include <expat.h>
#include <limits>
#include <memory>
#include <string>

namespace fabseq {

namespace {

std::string_view without_prefix(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

struct Free {
  void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
};

/// The call in hand. No exception may pass through expat.
struct Call {
  XML_Parser parser = nullptr;
  const std::function<void(std::string_view, const XmlAttributes&)>* f = nullptr;
  std::exception_ptr thrown;
};

void XMLCALL on_start(void* data, const XML_Char* name, const XML_Char** attributes) {
  auto& call = *static_cast<Call*>(data);
  if (call.thrown) return;
  try {
    (*call.f)(without_prefix(name), XmlAttributes(attributes));
  } catch (...) {
    call.thrown = std::current_exception();
    (void)XML_StopParser(call.parser, XML_FALSE);
  }
}

}  // namespace

std::string_view XmlAttributes::operator[](std::string_view name) const {
  for (const char* const* pair = pairs_; *pair != nullptr; pair += 2)
    if (without_prefix(pair[0]) == name) return pair[1];
  return {};
}

std::string_view XmlAttributes::exactly(std::string_view name) const {
  for (const char* const* pair = pairs_; *pair != nullptr; pair += 2)
    if (pair[0] == name) return pair[1];
  return {};
}

void for_each_xml_element(std::string_view text,
                          const std::function<void(std::string_view, const XmlAttributes&)>& f) {
  const std::unique_ptr<XML_ParserStruct, Free> parser(XML_ParserCreate(nullptr));
  if (parser == nullptr) throw InputError("cannot be read: no memory");
  Call call{.parser = parser.get(), .f = &f, .thrown = {}};
  XML_SetUserData(parser.get(), &call);
  XML_SetStartElementHandler(parser.get(), on_start);
  constexpr std::size_t most = std::size_t{1} << 26;
  XML_Status status = XML_STATUS_OK;
  do {
    const std::string_view part = text.substr(0, most);
    text.remove_prefix(part.size());
    status = XML_Parse(parser.get(), part.data(), static_cast<int>(part.size()),
                       text.empty() ? XML_TRUE : XML_FALSE);
  } while (status == XML_STATUS_OK && !text.empty());
  if (call.thrown) std::rethrow_exception(call.thrown);
  if (status != XML_STATUS_OK)
    throw InputError("cannot be read (" + std::string(XML_ErrorString(XML_GetErrorCode(parser.get()))) +
                     " in line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) + ")");
}

}  // namespace fabseq
