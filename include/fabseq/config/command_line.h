// SPDX-License-Identifier: MIT
/// \file
/// fabseq's own command line; what it does not know is PETSc's.
#pragma once

#include "fabseq/config/config.h"

#include <mpi.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// The parsed command line.
struct CommandLine {
  std::string config_file;
  Task task = Task::optimize;
  std::optional<std::string> output;         ///< -output
  std::optional<std::string> design_file;    ///< -design
  std::optional<std::string> sequence_file;  ///< -sequence
  std::optional<std::string> restart;        ///< -restart: a directory, or "auto"
  std::optional<double> max_wall_time;       ///< -max_wall_time, seconds
  bool overwrite = false;                    ///< -overwrite
  bool help = false, version = false;
  bool help_markdown = false;  ///< -help_markdown: print reference_table()
  /// -set and flat options in order: dotted path of a config key and the text of its value.
  std::vector<std::pair<std::string, std::string>> overrides;
  std::vector<std::string> petsc_arguments;  ///< argv[0] and all that is not fabseq's own
  std::string text;                          ///< the whole command line, for the record
};

/// Takes fabseq's options out of argv. Throws InputError for an unknown -task, a missing value, a word that
/// belongs to no option, or no -config (unless -help, -help_markdown or -version is given). Needs neither MPI
/// nor PETSc.
CommandLine parse_command_line(int argc, const char* const* argv);

/// Puts a value into a config. `path`: keys joined by dots; entries of lists by index, or by their "type"
/// (the first that has it). Missing objects are made. `text`: JSON, or else a string. Throws InputError where
/// the path cannot be followed; unknown keys are found by make_config().
void apply_override(Json& document, const std::string& path, const std::string& text);

/// Reads the config file (rank 0 reads, all ranks get the text), applies the overrides, validates, and checks
/// that the files it names can be read and that it suits the task. Collective on `comm`; throws InputError on
/// all ranks alike.
Config read_config(MPI_Comm comm, const CommandLine& command_line);

/// Text of -help: usage, options, and the table of keys with unit, default, range and meaning.
std::string help_text();
/// List of all config keys in Markdown, as docs/reference.md holds it, without the end of its last line.
std::string reference_table();

}  // namespace fabseq
