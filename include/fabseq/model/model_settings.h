// SPDX-License-Identifier: MIT
/// \file
/// What is built and simulated, and what is asked of it: the settings of all modules that a Model is made of.
#pragma once

#include "fabseq/grid/domain_settings.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/machine/tool_settings.h"
#include "fabseq/part/node_set.h"
#include "fabseq/part/part.h"
#include "fabseq/process/build_clock.h"
#include "fabseq/process/process_settings.h"
#include "fabseq/responses/term.h"
#include "fabseq/sequence/sequence_settings.h"
#include "fabseq/solve/solver_settings.h"
#include "fabseq/thermal/thermal_settings.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The sequences that others are compared with.
struct BaselineSettings {
  std::optional<int> layers;      ///< none: as thick as the layers of the design
  std::vector<double> direction;  ///< of the planar layers; empty: the plate's normal
  bool best_direction = false;    ///< also planar layers in the best of several directions
  bool even = true;               ///< also layers of equal thickness along the part
};

/// Section "baseline".
Section<BaselineSettings> baseline_keys();

struct ModelSettings : DomainSettings {
  PartDescription part;
  BuildPlate plate;
  std::map<std::string, NodeSetDescription> node_sets;
  MaterialSettings material;
  ProcessSettings process;
  std::optional<ThermalSettings> thermal;  ///< none: strains do not follow the temperature
  SequenceSettings sequence;
  LayerSettings layers;
  ProjectionSettings projection;
  std::vector<Term> objective, constraints;
  BaselineSettings baseline;
  ToolSettings tool;
  SolverSettings solver;

  /// How long a machine takes; none: not known.
  std::optional<BuildClock> clock() const {
    return build_clock(material, process, thermal ? thermal->passes : layers.passes);
  }
};

}  // namespace fabseq
