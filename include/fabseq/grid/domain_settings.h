// SPDX-License-Identifier: MIT
/// \file
/// The box and its grid as a config describes them.
#pragma once

#include "fabseq/grid/grid.h"

#include <string>
#include <vector>

namespace fabseq {

template <class Settings>
class Section;

/// Extent and grid of the box (see Domain). Vectors have one entry per axis, 2 or 3.
struct DomainSettings {
  std::vector<double> size;    ///< edge lengths, length unit
  std::vector<double> origin;  ///< lower corner, length unit; empty: 0
  std::vector<int> elements;   ///< number of elements along each axis
  double thickness = 1.0;      ///< 2D only, length unit
  std::string unit;            ///< name of the length unit, a label; empty: none

  int dimension() const { return static_cast<int>(elements.size()); }
  template <int Dim>
  Domain<Dim> domain() const {
    Domain<Dim> result;
    for (int axis = 0; axis < Dim; ++axis) {
      result.size[axis] = size[axis];
      if (!origin.empty()) result.origin[axis] = origin[axis];
      result.elements[axis] = elements[axis];
    }
    result.thickness = thickness;
    return result;
  }
};

/// Section "domain".
Section<DomainSettings> domain_keys();

}  // namespace fabseq
