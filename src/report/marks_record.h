// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/machine/marked_elements.h"

namespace fabseq {

/// The place of marked elements; null if there are none.
inline Json place_record(const MarkedElements& marked) {
  return marked.at.empty() ? Json() : Json(marked.at);
}

/// How many there are, where, and in which layers.
inline Json marks_record(const MarkedElements& marked) {
  return Json::object(
      {{"elements", marked.elements}, {"at", place_record(marked)}, {"per_layer", marked.per_layer}});
}

}  // namespace fabseq
