// SPDX-License-Identifier: MIT
#include "fabseq/run/restart.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/config/config_difference.h"
#include "fabseq/files/checkpoint.h"
#include "fabseq/files/seal.h"

#include <hdf5.h>
#include <petscsys.h>

#include <cstdint>
#include <filesystem>

namespace fabseq {

namespace {

/// Changes with the layout of checkpoints.
constexpr int format = 4;

/// Covers the densities and their places; a sum, so that it does not matter which rank has which elements.
template <int Dim>
std::string part_checksum(const Part<Dim>& part) {
  const Grid<Dim>& grid = part.grid();
  std::uint64_t sum = 0;
  for (std::size_t e = 0; e < part.elements().size(); ++e) {
    const std::int64_t place = grid.all_elements().offset(grid.owned_elements().index(part.elements()[e]));
    Checksum checksum;
    checksum.add(&place, sizeof place);
    checksum.add(&part.part_density()[e], sizeof(double));
    sum += checksum.value();
  }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, grid.comm());
  return std::to_string(sum);
}

[[noreturn]] void refuse_other_problem(const std::string& what, const std::string& difference) {
  throw InputError("-restart: " + what + " is of another problem: " + difference +
                   "; allowed to change: name, output, solver, optimizer.max_iterations, "
                   "optimizer.change_tolerance, optimizer.objective_tolerance, optimizer.window");
}

template <int Dim>
void require_same_problem(const Setup<Dim>& setup, const std::string& path) {
  const std::string name = "checkpoint '" + path + "'";
  const CheckpointState found = read_checkpoint_scalars(setup.world(), path);
  if (found.integer("format") != format)
    throw InputError("-restart: " + name + " has format " + std::to_string(found.integer("format")) +
                     "; allowed: " + std::to_string(format));
  const std::string difference =
      config_difference(parse_json(found.text("config"), path), setup.config.effective);
  if (!difference.empty()) refuse_other_problem(name, difference);
  if (found.text("part_checksum") != part_checksum(setup.part))
    refuse_other_problem(name, "/part has other elements or densities than it had");
}

/// What -restart auto finds without a checkpoint may be replaced only by a run of the same problem, which
/// would lead to the same result.
void require_same_config(MPI_Comm comm, const std::string& directory, const Json& effective) {
  const std::string file = directory + "/config.json";
  const std::string text = broadcast(comm, rank_of(comm) == 0 ? read_file_if_there(file) : "");
  if (text.empty()) return;
  const std::string difference = config_difference(parse_json(text, file), effective);
  if (!difference.empty()) refuse_other_problem("the run in '" + directory + "'", difference);
}

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
  if (config.part.mesh) record["run"]["mesh_placement"] = config.part.mesh->placement();
  return record;
}

/// Whether two paths lead to the same directory, which is there. Collective.
bool same_directory(MPI_Comm comm, const std::string& a, const std::string& b) {
  std::error_code error;
  return any(comm, rank_of(comm) == 0 && std::filesystem::equivalent(a, b, error));
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

std::string output_path(const Config& config, const CommandLine& command_line) {
  if (command_line.output) return *command_line.output;
  const bool of_restart = command_line.restart && *command_line.restart != "auto";
  return of_restart ? *command_line.restart : "output/" + config.name;
}

template <int Dim>
std::optional<Restart> find_restart(const Setup<Dim>& setup, const CommandLine& command_line) {
  if (!command_line.restart) return std::nullopt;
  const MPI_Comm comm = setup.world();
  const std::string output = output_path(setup.config, command_line);
  const bool automatic = *command_line.restart == "auto";
  const std::string directory = automatic ? output : *command_line.restart;
  const std::string path = find_checkpoint(comm, directory);
  const bool coarse = path.empty() && setup.config.optimizer.coarse_iterations > 0 &&
                      !find_checkpoint(comm, directory + "/" + coarse_folder).empty();
  if (path.empty() && !automatic && !coarse)
    throw InputError("-restart: no checkpoint in '" + directory +
                     "'; allowed: the output directory of a run that has left one, or auto");
  if (path.empty()) {
    require_same_config(comm, directory, setup.config.effective);
    if (coarse) return std::nullopt;  // which is where it goes on
    print("-restart auto: no checkpoint in '" + directory + "' yet, a new run begins");
    return std::nullopt;
  }
  require_same_problem(setup, path);
  Restart restart{directory, same_directory(comm, directory, output), path.substr(path.rfind('/') + 1), {}};
  setup.groups.run([&] { restart.state = read_checkpoint(path, setup.design_layout()); });
  print("continues after iteration " + std::to_string(restart.state.integer("iteration")) + " of '" + path +
        "'");
  return restart;
}

template <int Dim>
void save_problem(const Setup<Dim>& setup, CheckpointState& state) {
  state.set_scalar("format", format);
  state.set_scalar("fabseq", FABSEQ_VERSION);
  state.set_scalar("name", setup.config.name);
  state.set_scalar("config", to_text(setup.config.effective));
  state.set_scalar("part_checksum", part_checksum(setup.part));
}

template <int Dim>
OutputDirectory make_output_directory(const Setup<Dim>& setup, const CommandLine& command_line,
                                      bool continues) {
  const MPI_Comm comm = setup.world();
  const std::string path = output_path(setup.config, command_line);
  const bool goes_on = command_line.restart == "auto" ||
                       (command_line.restart && same_directory(comm, *command_line.restart, path));
  const bool replaces = command_line.overwrite || goes_on;
  if (replaces && !continues) require_inputs_to_stay(setup.config, command_line, comm, path);
  OutputDirectory directory =
      continues ? OutputDirectory::continued(comm, path) : OutputDirectory(comm, path, replaces);
  if (command_line.overwrite && !command_line.restart) directory.remove_coarse_runs();
  directory.write("config.json", to_text(config_record(setup.config, command_line, comm), 2) + "\n");
  return directory;
}

FABSEQ_INSTANTIATE_FUNCTION(find_restart);
FABSEQ_INSTANTIATE_FUNCTION(save_problem);
FABSEQ_INSTANTIATE_FUNCTION(make_output_directory);

}  // namespace fabseq
