// SPDX-License-Identifier: MIT
#include "fabseq/output/run_place.h"

namespace fabseq {

RunPlace RunPlace::inside(const std::string& folder) const {
  RunPlace result{directory + "/" + folder, restart};
  if (restart && !restarts_automatically()) result.restart = *restart + "/" + folder;
  return result;
}

RunPlace place_of_run(const Config& config, const CommandLine& command_line) {
  RunPlace result{"output/" + config.name, command_line.restart};
  if (command_line.output)
    result.directory = *command_line.output;
  else if (result.restart && !result.restarts_automatically())
    result.directory = *result.restart;
  return result;
}

}  // namespace fabseq
