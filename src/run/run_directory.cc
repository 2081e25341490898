// SPDX-License-Identifier: MIT
#include "fabseq/run/run_directory.h"

#include "fabseq/base/mpi.h"
#include "fabseq/run/restart.h"

#include <hdf5.h>
#include <petscsys.h>

namespace fabseq {

namespace {

Json config_record(const Config& config, const CommandLine& command_line, MPI_Comm comm) {
  char petsc[256];
  check(PetscGetVersion(petsc, sizeof petsc));
  char mpi[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(mpi, &length);
  Json record = config.effective;
  record["run"] = Json::object({{"command_line", command_line.text},
                                {"fabseq", FABSEQ_VERSION},
                                {"petsc", petsc},
                                {"mpi", mpi},
                                {"hdf5", H5_VERS_INFO},
                                {"ranks", size_of(comm)}});
  return record;
}

}  // namespace

template <int Dim>
OutputDirectory make_output_directory(const Setup<Dim>& setup, const CommandLine& command_line,
                                      bool continues) {
  const MPI_Comm comm = setup.world();
  const std::string path = output_path(setup.config, command_line);
  const bool goes_on = command_line.restart == "auto" ||
                       (command_line.restart && same_directory(comm, *command_line.restart, path));
  const bool replaces = command_line.overwrite || goes_on;
  OutputDirectory directory =
      continues ? OutputDirectory::continued(comm, path) : OutputDirectory(comm, path, replaces);
  if (command_line.overwrite && !command_line.restart) directory.remove_coarse_runs();
  directory.write("config.json", to_text(config_record(setup.config, command_line, comm), 2) + "\n");
  return directory;
}

FABSEQ_INSTANTIATE_FUNCTION(make_output_directory);

}  // namespace fabseq
