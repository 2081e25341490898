// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/config/config.h"

#include <optional>
#include <string>

namespace fabseq {

/// Where a run writes and what it continues from: as the command line says, or, of a run with which another
/// one begins, in a folder of that one's.
struct RunPlace {
  std::string directory;               ///< the output directory
  std::optional<std::string> restart;  ///< as -restart names it: the directory of a run, or "auto"

  bool restarts_automatically() const { return restart == "auto"; }
  /// Places a run in a folder: it continues from the same folder of the run that this one continues from.
  RunPlace inside(const std::string& folder) const;
};

/// Place of the run that the command line asks for: -output, the directory of -restart DIR, or output/NAME.
RunPlace place_of_run(const Config& config, const CommandLine& command_line);

}  // namespace fabseq
