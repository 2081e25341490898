// SPDX-License-Identifier: MIT
/// \file
/// Terms of the objective and constraints.
#pragma once

#include <optional>
#include <string>

namespace fabseq {

enum class TermScaling { first, current };

struct ObjectiveTerm {
  std::string type;  ///< distortion, layer_uniformity, segmentation_alignment
  double weight = 1.0;
  double normalize = 100.0;
  TermScaling scaling = TermScaling::first;
  std::string measure;                ///< distortion: displacement, flatness, layerwise
  std::string nodes;                  ///< distortion: name of a node set
  int axis = -1;                      ///< flatness
  bool after_release = false;         ///< displacement, flatness: of the part cut from the plate
  bool mean = false;                  ///< displacement: divide by the number of nodes
  std::optional<bool> least_squares;  ///< displacement, flatness; none: where it pays
  std::string form;                   ///< layer_uniformity: sum_of_squares, variance
  double band = 0.1;                  ///< segmentation_alignment: width in pseudo-time

  /// Whether it may be handed over as a sum of squares, if its measure is one: "auto" leaves terms with the
  /// published scaling as published.
  bool may_be_squares() const { return least_squares.value_or(scaling == TermScaling::current); }
};

struct ConstraintTerm {
  std::string type;     ///< layer_thickness, deposition_speed, continuity, minimum_layer_volume, last_layer,
                        ///< subpart_volume
  double target = 0.0;  ///< layer_thickness, length unit
  double tolerance = 0.1;  ///< layer_thickness, subpart_volume, relative
  double least_volume =
      0.0;                 ///< layer_thickness, last_layer: of the mean volume; layers with less are slivers
  double slack = 1e-3;     ///< deposition_speed
  double limit = 1e-3;     ///< continuity
  double fraction = 0.01;  ///< minimum_layer_volume, of the part's
};

}  // namespace fabseq
