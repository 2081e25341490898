// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/error.h"
#include "mesh/xml_elements.h"

#include <functional>
#include <string>
#include <string_view>

namespace fabseq {

class ZipArchive;

/// Error about what is whole in a file but not read here.
class NotReadError : public InputError {
 public:
  using InputError::InputError;
};

/// for_each_xml_element() for a file of an archive. InputErrors name it and ask for an intact file, except
/// those that are NotReadErrors.
void for_each_archived_element(const ZipArchive& archive, const std::string& name,
                               const std::function<void(std::string_view, const XmlAttributes&)>& f);

}  // namespace fabseq
