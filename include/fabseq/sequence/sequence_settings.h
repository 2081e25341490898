// SPDX-License-Identifier: MIT
/// \file
/// Where the pseudo-time comes from, as the config says it.
#pragma once

#include <any>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

class SequenceKind;

/// The optimizer's largest steps where the config leaves them to the sequence, relative to a variable's range
/// (docs/formulation.md 9).
struct MoveLimits {
  double first = 0.05;
  std::optional<double> last = 0.004;  ///< at the end of a run, at most; none: as large as before
  /// The same where a distortion may be handed over as squares. With larger steps the iterates of heat
  /// sequences swing between two states (docs/formulation.md 9, benchmarks/evidence/results/defaults.md).
  double last_with_squares = 0.001;
};

/// What the tool allows, as far as defaults of a sequence follow from it.
struct ToolRange {
  double max_tilt = 180.0;  ///< of the build direction from the plate's normal, degrees
  /// Least and largest local thickness, relative to the target; none: there is no torch.
  std::optional<std::array<double, 2>> thickness = std::nullopt;
};

/// What the settings of a sequence say before there is a part.
struct SequenceFacts {
  MoveLimits move_limits = {};
  /// The keys for which grad t is not defined, as messages have them: `type "file"`; empty: it is defined.
  std::string gradient_obstacle = "";
  std::optional<double> characteristic_length = std::nullopt;  ///< length unit; none: the model's default
  /// Keys of the section "sequence" that name HDF5 files, and the files' absolute paths.
  std::vector<std::pair<std::string, std::string>> files = {};
};

/// The settings of a sequence (docs/formulation.md 2, 3).
struct SequenceSettings {
  const SequenceKind* kind = nullptr;  ///< in the registry, not owned; never null in a config that was read
  std::any own;                        ///< the kind's own settings, such as HeatSettings
  SequenceFacts facts;

  /// The kind's own settings. Throws std::bad_any_cast if they are of another type.
  template <class Own>
  const Own& as() const {
    return std::any_cast<const Own&>(own);
  }
};

}  // namespace fabseq
