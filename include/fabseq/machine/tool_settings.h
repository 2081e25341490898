// SPDX-License-Identifier: MIT
/// \file
/// The torch and the bead that it lays.
#pragma once

#include <array>

namespace fabseq {

template <class Settings>
class Section;

/// Section "tool".
struct ToolSettings {
  double bead_width = 0.0;  ///< length unit; 0: two elements' longest edges
  /// Least and largest local thickness of a layer that the process can deposit, relative to the target.
  std::array<double, 2> thickness = {0.5, 1.5};
};

Section<ToolSettings> tool_keys();

}  // namespace fabseq
