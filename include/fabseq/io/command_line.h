/// \file
/// fabseq's own command line; what it does not know is PETSc's.
#pragma once

#include "fabseq/io/config.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The parsed command line.
struct CommandLine {
  std::string config_file;
  Task task = Task::optimize;
  std::optional<std::string> output;       ///< -output
  std::optional<std::string> design_file;  ///< -design
  bool overwrite = false;                  ///< -overwrite
  bool help = false, version = false;
  /// -set and flat options in order: dotted path of a config key and the text of its value.
  std::vector<std::pair<std::string, std::string>> overrides;
  std::vector<std::string> petsc_arguments;  ///< argv[0] and all that is not fabseq's own
  std::string text;                          ///< the whole command line, for the record
};

/// Takes fabseq's options out of argv. Throws InputError for an unknown -task, a missing value or no -config.
/// Needs neither MPI nor PETSc.
CommandLine parse_command_line(int argc, const char* const* argv);

/// Reads the config file (rank 0 reads, all ranks get the text), applies the overrides and validates. Collective on `comm`.
Config read_config(MPI_Comm comm, const CommandLine& command_line);

/// Text of -help: usage, options, and the table of keys with unit, default, range and meaning.
std::string help_text();
/// Reference table of all config keys in Markdown, as it stands in docs/users-guide.md.
std::string reference_table();

}  // namespace fabseq
