// SPDX-License-Identifier: MIT
/// \file
/// fabseq's own command line. Options that it does not know are left to PETSc.
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
  bool picture = false;                      ///< -picture
  bool repair = false;                       ///< -repair
  bool help = false, version = false;
  bool help_markdown = false;  ///< -help_markdown: print reference_table()
  /// -set and flat options in their order: dotted path of a config key, and the text of its value.
  std::vector<std::pair<std::string, std::string>> overrides;
  std::vector<std::string> petsc_arguments;  ///< argv[0] and all options that are not fabseq's own
  std::string text;                          ///< the whole command line, for the record
};

/// Parses argv and separates fabseq's options from PETSc's. Needs neither MPI nor PETSc. Throws InputError
/// for an unknown option or -task, a missing value, a word that belongs to no option, options that exclude
/// each other, or a missing -config (unless -help, -help_markdown or -version is given).
CommandLine parse_command_line(int argc, const char* const* argv);

/// Throws InputError if PETSc has one of fabseq's own options, from PETSC_OPTIONS, a file .petscrc or
/// -options_file: it would have no effect. After PetscInitialize. Not collective.
void refuse_own_options_of_petsc();

/// Puts a value into a config. `path` consists of keys joined by dots. It selects entries of lists by index
/// or by their "type" (the first entry that has it). Missing objects are created. `text` is JSON; text that
/// is not JSON is taken as a string. Throws InputError if the path cannot be followed; make_config() finds
/// unknown keys. Not collective.
void apply_override(Json& document, const std::string& path, const std::string& text);

/// Reads the config file (rank 0 reads, all ranks get the text), applies the overrides, validates the config,
/// and checks that it suits the task and that the files it names can be read. Collective on `comm`. Throws
/// the same InputError on all ranks.
Config read_config(MPI_Comm comm, const CommandLine& command_line);
/// The same for a document that all ranks have; `directory`: absolute, which relative paths in it refer to.
Config read_config(MPI_Comm comm, Json document, const std::string& directory,
                   const CommandLine& command_line);

/// The document of the config file with what follows from its machine's file in place of the key `machine`;
/// nothing else of it is looked at. Collective on `comm`. Throws InputError on all ranks where that file
/// cannot be used.
Json config_with_machine(MPI_Comm comm, const CommandLine& command_line);

/// A config's name and its part's surface.
struct NamedSurface {
  std::string name;
  PlacedSurface surface;
};

/// Reads what of the config file says where the mesh of its part stands, and the mesh. Throws InputError on
/// all ranks, as for a part from no mesh. Collective on `comm`.
NamedSurface read_surface(MPI_Comm comm, const CommandLine& command_line);

/// Text of -help: usage, options, and the table of keys with unit, default, range and meaning.
std::string help_text();
/// List of all config keys in Markdown, as docs/reference.md holds it, without the final line break.
std::string reference_table();

}  // namespace fabseq
