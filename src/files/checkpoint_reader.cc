// SPDX-License-Identifier: MIT

#include "fabseq/base/error.h"
#include "fabseq/base/hdf5.h"
#include "fabseq/base/input_file.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/files/checkpoint.h"
#include "fabseq/files/hdf5_attribute.h"
#include "fabseq/files/hdf5_writer.h"

#include <array>
#include <filesystem>
#include <vector>

namespace fabseq {

namespace {

constexpr std::array<const char*, 2> slots = {"checkpoint/slot_0.h5", "checkpoint/slot_1.h5"};

/// Path of an intact slot, of which the one that `newest` names is tried first, "" if there is none; warns of
/// those that are damaged. Rank 0 calls it.
std::string search(const std::string& directory) {
  const std::string newest = newest_checkpoint(directory);
  std::vector<std::string> candidates(slots.begin(), slots.end());
  if (newest == slots[1]) std::swap(candidates[0], candidates[1]);
  std::string faults;
  for (const std::string& slot : candidates) {
    std::string path = directory + "/" + slot;
    std::error_code error;
    if (newest.empty() && !std::filesystem::exists(path, error)) continue;
    try {
      (void)verify_checkpoint(path);
      if (!faults.empty()) warn(faults + "; '" + path + "', which is older, is used");
      return path;
    } catch (const Error& fault) {
      faults += std::string(faults.empty() ? "" : "; ") + fault.what();
    }
  }
  if (!newest.empty())
    throw InputError("-restart: " + faults + "; allowed: a directory with an intact checkpoint");
  if (!faults.empty()) warn(faults);
  return "";
}

std::vector<double> read_array(hid_t dataset, const std::string& name) {
  const Hdf5Dataspace space(H5Dget_space(dataset));
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw InputError("-restart: dataset '" + name + "' of the checkpoint cannot be read");
  return values;
}

/// JSON text with scalars, arrays and the names of the fields; as text, every finite number keeps all its
/// bits. Rank 0 calls it.
std::string read_description(const std::string& path) {
  silence_hdf5();
  const Hdf5File file(reading_problem(path).empty() ? H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)
                                                    : H5I_INVALID_HID);
  if (!file) throw InputError("-restart: '" + path + "' cannot be opened");
  Json scalars = Json::object(), arrays = Json::object(), fields = Json::array();
  for (const std::string& name : attribute_names(file))
    if (const std::optional<Json> value = read_attribute(file, name); value && name != "checksum_of_scalars")
      scalars[name] = *value;
  for (const std::string& name : dataset_names(file)) {
    const Hdf5Dataset dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT));
    if (H5Sget_simple_extent_ndims(Hdf5Dataspace(H5Dget_space(dataset))) == 1)
      arrays[name] = read_array(dataset, name);
    else
      fields.push_back(name);
  }
  return Json::object({{"scalars", scalars}, {"arrays", arrays}, {"fields", fields}}).dump();
}

Json broadcast_description(MPI_Comm comm, const std::string& path) {
  std::string text;
  run_on_first(comm, [&] { text = read_description(path); });
  return parse_json(broadcast(comm, text), "checkpoint");
}

CheckpointState without_fields(const Json& description) {
  CheckpointState state;
  for (const auto& [name, value] : description.at("scalars").items()) state.set_scalar(name, value);
  for (const auto& [name, values] : description.at("arrays").items())
    state.set_array(name, values.get<std::vector<double>>());
  return state;
}

}  // namespace

std::string find_checkpoint(MPI_Comm comm, const std::string& directory) {
  std::string found;
  run_on_first(comm, [&] { found = search(directory); });
  return broadcast(comm, found);
}

CheckpointState read_checkpoint_scalars(MPI_Comm comm, const std::string& path) {
  return without_fields(broadcast_description(comm, path));
}

template <int Dim>
CheckpointState read_checkpoint(const std::string& path, const DesignLayout<Dim>& layout) {
  const Json description = broadcast_description(layout.grid.comm(), path);
  CheckpointState state = without_fields(description);
  for (const Json& name : description.at("fields"))
    state.set_field(name.get<std::string>(),
                    layout.from_grid(read_field(layout.grid, layout.on_nodes, path, name.get<std::string>(),
                                                "-restart", "-restart", layout.components)));
  return state;
}

FABSEQ_INSTANTIATE_FUNCTION(read_checkpoint);

}  // namespace fabseq
