// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/machine/marked_elements.h"
#include "fabseq/part/part.h"

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// How thick a binary layer is at each of its elements, (T_j - T_{j-1}) / |grad t|, a part field, length unit
/// (docs/formulation.md 13.1). Where the time of an element is beyond its layer's, before T_0 or after T_N,
/// the layer reaches that far. Empty without a gradient or time points. Local.
/// \param time         pseudo-time, a part field
/// \param gradient     TimeGradient::values
/// \param layer_index  the layer that builds each part element, from 1
/// \param most         the thickness where the gradient vanishes but for its regularization
template <int Dim>
std::vector<double> local_thickness(std::span<const double> time, std::span<const double> gradient,
                                    const LayerDensities& layers, std::span<const double> layer_index,
                                    double most = std::numeric_limits<double>::infinity());

/// What a local thickness is between, and the elements at which it lies outside of an allowed range.
struct ThicknessRange {
  double least = 0.0, largest = 0.0;  ///< length unit
  std::vector<double> largest_at;     ///< centre of an element with the largest, [axis]
  bool largest_is_meeting = false;    ///< whether fronts meet there (meeting_fronts()): it is no thick layer
  MarkedElements without_end;         ///< where the time hardly changes: as thick as the part is long
  std::optional<MarkedElements> outside;  ///< by what share of its end they miss it; none without a range
  double worst = 0.0;                     ///< that of the element that misses it by most, length unit
};

/// Returns by what share of its end each thickness misses an allowed range; none above 0: it lies in it.
std::vector<double> beyond_range(std::span<const double> thickness, const std::array<double, 2>& allowed);

/// The range of a local thickness, none if it is not defined. Collective on the grid's communicator.
/// \param gradient     TimeGradient::values
/// \param meetings     meeting_fronts()
/// \param allowed      least and largest length
/// \param layer_index  the layer that builds each part element, from 1
/// \param layers       number of layers
template <int Dim>
std::optional<ThicknessRange> thickness_range(const Part<Dim>& part, std::span<const double> thickness,
                                              std::span<const double> gradient,
                                              std::span<const double> meetings,
                                              const std::optional<std::array<double, 2>>& allowed,
                                              std::span<const double> layer_index, int layers);

}  // namespace fabseq
