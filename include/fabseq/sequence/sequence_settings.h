// SPDX-License-Identifier: MIT
/// \file
/// Where the pseudo-time comes from.
#pragma once

#include "fabseq/part/shape.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

template <class Settings>
class Section;

/// Where the pseudo-time comes from.
enum class SequenceType { heat, direct, planar, file };
/// Where the variables of a direct sequence are.
enum class DesignLocation { elements, nodes };
/// Scale on which the optimizer moves the diffusivity.
enum class VariableScale { log, linear };
/// Mass matrix of the drain; automatic: lumped where the temperature would otherwise leave its range.
enum class MassRule { automatic, consistent, lumped };

/// Settings of the sequence (docs/formulation.md 2.1, 2.2 for heat, 2.3 for direct, 3.3 for planar, 3.1 for
/// file).
struct SequenceSettings {
  SequenceType type = SequenceType::heat;
  VariableScale scale = VariableScale::log;
  MassRule mass = MassRule::automatic;
  std::optional<double> initial;  ///< heat: uniform diffusivity; none: from the distance to the plate
  double drain = 1.0;             ///< heat: alpha times the square of the characteristic length
  std::optional<double> characteristic_length;  ///< length unit; none: the part's longest edge
  /// For heat: bounds of the diffusivity in the part, and the diffusivity outside.
  double min_diffusivity = 1e-3, max_diffusivity = 1.0, void_diffusivity = 1e-3;
  double filter_radius = 0.0;                          ///< heat, direct: length unit; 0: no filter
  DesignLocation location = DesignLocation::elements;  ///< direct: where the pseudo-time lives
  std::optional<Shape> start;     ///< direct: where the pseudo-time is 0; none: on the plate
  std::vector<double> direction;  ///< planar: build direction; empty: the plate's normal
  std::string file;               ///< file: absolute path of an HDF5 file
  std::string dataset = "time";   ///< file: its dataset, axes [z][y][x]
};

/// Section "sequence".
Section<SequenceSettings> sequence_keys();

}  // namespace fabseq
