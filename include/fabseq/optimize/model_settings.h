// SPDX-License-Identifier: MIT
/// \file
/// What is built and simulated, and what is asked of it: the settings of all modules that a Model is made of.
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/part/node_set.h"
#include "fabseq/part/part.h"
#include "fabseq/process/process_settings.h"
#include "fabseq/responses/term_settings.h"
#include "fabseq/sequence/sequence_settings.h"
#include "fabseq/solve/solver_settings.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The planar sequence that others are compared with.
struct BaselineSettings {
  std::optional<int> layers;      ///< none: as thick as the layers of the design
  std::vector<double> direction;  ///< empty: the plate's normal
};

/// Vectors have an entry per axis.
struct ModelSettings {
  std::vector<double> size;
  std::vector<int> elements;
  double thickness = 1.0;
  PartDescription part;
  BuildPlate plate;
  std::map<std::string, NodeSetDescription> node_sets;
  MaterialSettings material;
  ProcessSettings process;
  SequenceSettings sequence;
  LayerSettings layers;
  ProjectionSettings projection;
  std::vector<ObjectiveTerm> objective;
  std::vector<ConstraintTerm> constraints;
  BaselineSettings baseline;
  SolverSettings solver;

  /// Whether a term measures after the release.
  bool has_release() const {
    return std::any_of(objective.begin(), objective.end(),
                       [](const ObjectiveTerm& term) { return term.after_release; });
  }
  template <int Dim>
  Domain<Dim> domain() const {
    Domain<Dim> result;
    for (int axis = 0; axis < Dim; ++axis) {
      result.size[axis] = size[axis];
      result.elements[axis] = elements[axis];
    }
    result.thickness = thickness;
    return result;
  }
};

}  // namespace fabseq
