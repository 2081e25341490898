// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// How a field goes on beyond the last centre before the part's surface.
enum class BeyondCentres {
  slope,  ///< with the slope before
  value   ///< as it is there, so that no value leaves those of the elements around
};

/// A part field, such as the pseudo-time, on a grid with twice as many elements along each axis of the same
/// box (docs/developer/numerics.md 12): linear between the centres of elements of the part. Beyond the last
/// centre before the part's surface it goes on as `beyond` says; values outside the part do not enter.
/// Elements of the fine part whose coarse element is no part element take the mean of what their nearest part
/// elements would go on to. A linear field that goes on with its slope stays what it is wherever the part is
/// two elements thick.
///
/// `part`: of the field. `fine`: a part field of it is returned. Both grids have the same communicator, on
/// which the call is collective; a rank gathers what its own fine elements lie in. Source: fabseq's own.
template <int Dim>
std::vector<double> refined_field(const Part<Dim>& part, std::span<const double> field, const Part<Dim>& fine,
                                  BeyondCentres beyond = BeyondCentres::slope);

}  // namespace fabseq
