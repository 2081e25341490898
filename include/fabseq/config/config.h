// SPDX-License-Identifier: MIT
/// \file
/// What a user asks for, typed: the result of reading and validating a config file (docs/reference.md,
/// reference table).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/part/node_set.h"
#include "fabseq/part/part.h"
#include "fabseq/process/process_settings.h"
#include "fabseq/responses/term_settings.h"
#include "fabseq/sequence/sequence_settings.h"
#include "fabseq/solve/solver_settings.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

enum class Task { optimize, simulate, evaluate, check_gradients, check };

struct BaselineSettings {
  std::optional<int> layers;      ///< none: round(height / target), else the layer count
  std::vector<double> direction;  ///< empty: the plate's normal
};

struct OptimizerSettings {
  int max_iterations = 400;
  double change_tolerance = 0.0;
  double objective_tolerance = 0.0;
  int window = 5;  ///< iterations over which both are looked at
  double move_limit = 0.05,
         final_move_limit = 0.004;  ///< of the variable's range; "auto" already resolved by scale
  double asymptote_initial = 0.5, asymptote_increase = 1.2, asymptote_decrease = 0.7, asymptote_floor = 0.1;
  double constraint_margin = 0.95;
  int binary_iterations = 0;                         ///< the last ones, judged by binary layers
  int coarse_iterations = 0;                         ///< before the others, at half the resolution
  int coarse_grids = 1;                              ///< among which they are shared out
  int earlier_iterations = 0, later_iterations = 0;  ///< of other runs, in the schedules of this one
};

struct OutputSettings {
  int every = 15;
  int checkpoint_every = 10;
  bool stages = false;
};

/// A validated config. Vectors have `dimension` entries.
struct Config {
  std::string name;
  int dimension = 3;
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
  OptimizerSettings optimizer;
  SolverSettings solver;
  OutputSettings output;

  Json effective;  ///< every key with its value, defaults filled in, paths absolute: runs again to the same
                   ///< result

  /// Whether |grad t| is defined, and with it whatever thickness means.
  bool has_time_gradient() const {
    return sequence.type != SequenceType::file &&
           !(sequence.type == SequenceType::direct && sequence.location == DesignLocation::elements);
  }
  /// Target thickness of the first layer_thickness constraint, if there is one.
  std::optional<double> target_thickness() const;
  /// Whether the sequence's field is kept from the optimizer.
  bool has_fixed_time() const { return layers.multi_planar && layers.multi_planar->fixed_time; }
  /// Whether a term measures after the release.
  bool has_release() const;
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

/// Validates `document` (config text parsed, -set and flat options applied) against the table of keys and
/// fills in defaults. `directory`: absolute directory that relative paths in the config refer to. Not
/// collective; the same on all ranks. Throws InputError with the JSON pointer of the offending key, what was
/// found and what is allowed.
Config make_config(const Json& document, const std::string& directory);

}  // namespace fabseq
