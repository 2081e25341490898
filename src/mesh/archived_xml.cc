// SPDX-License-Identifier: MIT
#include "mesh/archived_xml.h"

#include "mesh/zip_archive.h"

namespace fabseq {

void for_each_archived_element(const ZipArchive& archive, const std::string& name,
                               const std::function<void(std::string_view, const XmlAttributes&)>& f) {
  const std::string text = archive.read(name);
  try {
    for_each_xml_element(text, f);
  } catch (const NotReadError&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(error.what() + std::string(" of \"") + name +
                     "\" in its archive, needs an intact 3MF file");
  }
}

}  // namespace fabseq
