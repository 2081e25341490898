// SPDX-License-Identifier: MIT
#include "fabseq/mesh/length_units.h"

#include "mesh/text_values.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace fabseq {

namespace {

struct LengthUnit {
  double metres;
  std::initializer_list<std::string_view> names;  ///< without the s of several
};

}  // namespace

std::optional<double> metres_in(const std::string& unit) {
  static const LengthUnit units[] = {
      {1e-6, {"um", "\xc2\xb5m", "\xce\xbcm", "micron", "micrometer", "micrometre"}},
      {1e-3, {"mm", "millimeter", "millimetre"}},
      {1e-2, {"cm", "centimeter", "centimetre"}},
      {1.0, {"m", "meter", "metre"}},
      {0.0254, {"in", "inch", "inche", "\""}},
      {0.3048, {"ft", "foot", "feet"}}};
  std::string name = lower_case(unit);
  const bool several = name.size() > 3 && name.ends_with('s');
  if (several) name.pop_back();
  for (const LengthUnit& known : units)
    if (std::find(known.names.begin(), known.names.end(), name) != known.names.end()) return known.metres;
  return std::nullopt;
}

}  // namespace fabseq
