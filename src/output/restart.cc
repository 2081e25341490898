// SPDX-License-Identifier: MIT
#include "fabseq/output/restart.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"
#include "fabseq/config/config_difference.h"
#include "fabseq/files/checkpoint.h"
#include "fabseq/files/seal.h"
#include "fabseq/output/task_directory.h"

#include <cstdint>

namespace fabseq {

namespace {

/// Changes with the layout of checkpoints, and with what "auto" stands for in the config they hold.
constexpr int format = 5;

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
  const std::string difference = config_difference(parse_json(found.text("config"), path), setup.effective());
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

/// Whether a run with which that of the directory begins has left a checkpoint.
bool has_begun(MPI_Comm comm, const OptimizerSettings& optimizer, const std::string& directory) {
  std::string path = directory;
  for (int grid = 0; grid <= (optimizer.coarse_iterations > 0 ? optimizer.coarse_grids : 0); ++grid) {
    if (!optimizer.starts.empty() && !find_checkpoint(comm, path + "/" + starts_folder + "/1").empty())
      return true;
    path += std::string("/") + coarse_folder;
    if (optimizer.coarse_iterations > 0 && !find_checkpoint(comm, path).empty()) return true;
  }
  return false;
}

}  // namespace

template <int Dim>
std::optional<Restart> find_restart(const Setup<Dim>& setup, const RunPlace& place) {
  if (!place.restart) return std::nullopt;
  const MPI_Comm comm = setup.world();
  const bool automatic = place.restarts_automatically();
  const std::string directory = automatic ? place.directory : *place.restart;
  const std::string path = find_checkpoint(comm, directory);
  const bool begun = path.empty() && has_begun(comm, setup.config.optimizer, directory);
  if (path.empty() && !automatic && !begun)
    throw InputError("-restart: no checkpoint in '" + directory +
                     "'; allowed: the output directory of a run that has left one, or auto");
  if (path.empty()) {
    require_same_config(comm, directory, setup.effective());
    if (begun) return std::nullopt;  // which is where it goes on
    print("-restart auto: no checkpoint in '" + directory + "' yet, a new run begins");
    return std::nullopt;
  }
  require_same_problem(setup, path);
  Restart restart{
      directory, same_directory(comm, directory, place.directory), path.substr(path.rfind('/') + 1), {}};
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
  state.set_scalar("config", to_text(setup.effective()));
  state.set_scalar("part_checksum", part_checksum(setup.part));
}

FABSEQ_INSTANTIATE_FUNCTION(find_restart);
FABSEQ_INSTANTIATE_FUNCTION(save_problem);

}  // namespace fabseq
