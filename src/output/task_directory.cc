// SPDX-License-Identifier: MIT
#include "fabseq/output/task_directory.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"

#include <hdf5.h>
#include <petscsys.h>

#include <filesystem>
#include <system_error>
#include <utility>

namespace fabseq {

namespace {

/// `effective`: that of Setup.
Json config_record(const Config& config, Json effective, const CommandLine& command_line, MPI_Comm comm) {
  char petsc[256];
  check(PetscGetVersion(petsc, sizeof petsc));
  char mpi[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(mpi, &length);
  Json record = std::move(effective);
  record["run"] = Json::object({{"command_line", command_line.text},
                                {"fabseq", FABSEQ_VERSION},
                                {"petsc", petsc},
                                {"mpi", mpi},
                                {"hdf5", H5_VERS_INFO},
                                {"ranks", size_of(comm)}});
  if (config.part.mesh) record["run"]["mesh_placement"] = config.part.mesh->placement();
  std::error_code error;
  if (command_line.design_file)
    record["run"]["design"] = std::filesystem::absolute(*command_line.design_file, error).string();
  return record;
}

/// Refuses to replace the run that this one takes its design or its sequence from. Collective.
void require_inputs_to_stay(const Config& config, const CommandLine& command_line, MPI_Comm comm,
                            const std::string& directory) {
  const auto require = [&](const std::string& key, const std::string& file) {
    if (is_file_of_run(directory, file))
      refuse(key, shown(file) + " of the run that is to be replaced",
             "a copy of it elsewhere, or another directory with -output");
  };
  run_on_first(comm, [&] {
    if (command_line.design_file) require("-design", *command_line.design_file);
    for (const auto& [key, file] : config.sequence.facts.files) require(pointer_to("/sequence", key), file);
  });
}

}  // namespace

bool same_directory(MPI_Comm comm, const std::string& a, const std::string& b) {
  std::error_code error;
  return any(comm, rank_of(comm) == 0 && std::filesystem::equivalent(a, b, error));
}

template <int Dim>
OutputDirectory make_run_directory(const Setup<Dim>& setup, const CommandLine& command_line,
                                   const RunPlace& place, bool continues) {
  const MPI_Comm comm = setup.world();
  const std::string& path = place.directory;
  const bool goes_on =
      place.restarts_automatically() || (place.restart && same_directory(comm, *place.restart, path));
  const bool replaces = command_line.overwrite || goes_on;
  if (replaces && !continues) require_inputs_to_stay(setup.config, command_line, comm, path);
  OutputDirectory directory =
      continues ? OutputDirectory::continued(comm, path) : OutputDirectory(comm, path, replaces);
  if (command_line.overwrite && !place.restart) directory.remove_earlier_runs();
  directory.write("config.json",
                  to_text(config_record(setup.config, setup.effective(), command_line, comm), 2) + "\n");
  return directory;
}

template <int Dim>
OutputDirectory make_output_directory(const Setup<Dim>& setup, const CommandLine& command_line) {
  return make_run_directory(setup, command_line, place_of_run(setup.config, command_line),
                            /*continues=*/false);
}

FABSEQ_INSTANTIATE_FUNCTION(make_run_directory);
FABSEQ_INSTANTIATE_FUNCTION(make_output_directory);

}  // namespace fabseq
