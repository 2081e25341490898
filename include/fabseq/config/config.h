// SPDX-License-Identifier: MIT
/// \file
/// A config as typed settings: the result of reading and validating a config file (docs/reference.md,
/// reference table).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/model/model_settings.h"
#include "fabseq/optimize/optimizer_settings.h"

#include <memory>
#include <optional>
#include <string>

namespace fabseq {

/// What a run does (docs/reference.md, -task).
enum class Task { optimize, simulate, sensitivity, evaluate, check_gradients, check, surface, machine };

/// What a run writes on its way, and how often.
struct OutputSettings {
  int every = 15;                  ///< iterations between two dumps of the fields; 0: none
  int checkpoint_every = 10;       ///< iterations between two checkpoints; 0: none
  bool stages = false;             ///< whether to write the displacement after every layer
  bool stress = false;             ///< whether the end of a run tells of residual stress
  bool sensitivity = false;        ///< whether an optimization ends with the sensitivity table
  std::optional<bool> finer_grid;  ///< whether that table has a grid twice as fine; none: if memory allows
};

/// A validated config.
struct Config : ModelSettings {
  std::string name = "fabseq";
  OptimizerSettings optimizer;
  OutputSettings output;

  /// Every key with its value, defaults filled in, paths absolute. A run of it gives the same result.
  Json effective;

  /// Whether |grad t| is defined, and with it all that depends on thickness.
  bool has_time_gradient() const { return sequence.facts.gradient_obstacle.empty(); }
  /// Whether a response of that type needs the gradient of the pseudo-time, itself or as the torch's axis.
  bool needs_time_gradient(const ResponseType& type) const;
  /// Whether the layers are of the kind that a response of that type is for.
  bool has_layers_of(const ResponseType& type) const;
};

/// Validates `document` (the parsed config with -set and flat options applied) against the sections of keys
/// and fills in defaults. `directory`: absolute directory that relative paths in the config refer to. `mesh`:
/// the placed mesh of a config whose part is one. Not collective; the result is the same on all ranks. Throws
/// InputError with the JSON pointer of the offending key, what was found and what is allowed.
Config make_config(const Json& document, const std::string& directory,
                   std::shared_ptr<const PlacedMesh> mesh = nullptr);

/// The first half of make_config(): single values are valid, their relations are not checked yet.
Config read_settings(const Json& document, const std::string& directory,
                     std::shared_ptr<const PlacedMesh> mesh = nullptr);
/// The second half, and what makes a config of settings that were changed: sets what follows from others and
/// checks relations between keys. Throws InputError. Not collective.
void complete(Config& config);
/// complete() for settings that came from those of another config and were changed. Brings `effective` to
/// them first. Terms may have been left out, but not added or changed.
void complete_derived(Config& config);

/// How thick layers shall be: as layers.target says, or else the first constraint that has a target, for the
/// real layers of each simulated one. Not collective.
std::optional<TargetThickness> target_thickness(const Config& config);

/// Settings of the sequence that begins as entry number `start` of optimizer.starts says. `sequence`: the
/// completed section of that name, with other values for what is "auto" at most. Throws InputError, which
/// names the entry. Not collective.
SequenceSettings with_start(const Config& config, const Json& sequence, std::size_t start);

/// Checks relations between the keys of a config whose single values are valid, as complete() does at its
/// end. Throws InputError. Not collective.
void check_rules(const Config& config);

/// Checks what a task needs beyond a valid config. Throws InputError. Not collective.
void check_task(const Config& config, Task task);

}  // namespace fabseq
