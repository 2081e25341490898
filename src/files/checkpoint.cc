// SPDX-License-Identifier: MIT
#include "fabseq/files/checkpoint.h"

#include "fabseq/base/error.h"
#include "fabseq/base/hdf5.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/verdict.h"
#include "fabseq/files/hdf5_attribute.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/files/seal.h"

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

constexpr const char* scalar_checksum_name = "checksum_of_scalars";

/// Checksum of names and values (doubles bit by bit) in the order of the names.
std::uint64_t checksum_of(const std::map<std::string, Json>& scalars) {
  Checksum checksum;
  const auto add = [&](const auto& value) { checksum.add(&value, sizeof value); };
  for (const auto& [name, value] : scalars) {
    checksum.add(name.c_str(), name.size() + 1);
    if (value.is_boolean()) {
      add(static_cast<std::int64_t>(value.get<bool>()));
    } else if (value.is_number_integer()) {
      add(value.get<std::int64_t>());
    } else if (value.is_number()) {
      add(value.get<double>());
    } else if (value.is_string()) {
      const auto& text = value.get_ref<const std::string&>();
      checksum.add(text.c_str(), text.size() + 1);
    }
  }
  return checksum.value();
}

[[noreturn]] void throw_damaged(const std::string& file, const std::string& what) {
  throw OutputError("checkpoint '" + file + "' is damaged: " + what);
}

/// Checksum of a dataset's doubles, which are read slab by slab of the slowest axis; none if it cannot be
/// read.
std::optional<std::uint64_t> checksum_of_dataset(hid_t dataset) {
  const Hdf5Dataspace in_file(H5Dget_space(dataset));
  const int rank = in_file ? H5Sget_simple_extent_ndims(in_file) : -1;
  if (rank < 1) return std::nullopt;
  std::vector<hsize_t> start(static_cast<std::size_t>(rank), 0), count(start);
  if (H5Sget_simple_extent_dims(in_file, count.data(), nullptr) < 0) return std::nullopt;
  const hsize_t slabs = std::exchange(count[0], 1);
  hsize_t size = 1;
  for (const hsize_t extent : count) size *= extent;
  const Hdf5Dataspace in_memory(H5Screate_simple(1, &size, nullptr));
  std::vector<double> values(size);
  Checksum checksum;
  for (start[0] = 0; start[0] < slabs; ++start[0]) {
    if (H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
        H5Dread(dataset, H5T_NATIVE_DOUBLE, in_memory, in_file, H5P_DEFAULT, values.data()) < 0)
      return std::nullopt;
    checksum.add(values.data(), size * sizeof(double));
  }
  return checksum.value();
}

void verify_scalars(const std::string& path, hid_t file) {
  std::map<std::string, Json> scalars;
  for (const std::string& name : attribute_names(file)) {
    if (name == scalar_checksum_name) continue;
    const std::optional<Json> value = read_attribute(file, name);
    if (!value) throw_damaged(path, "attribute '" + name + "' cannot be read");
    scalars[name] = *value;
  }
  const std::optional<Json> expected = read_attribute(file, scalar_checksum_name);
  if (!expected || *expected != Json(checksum_of(scalars)))
    throw_damaged(path, "the checksum of the scalars is wrong");
}

/// The slot to write next, as a path within the output directory.
std::string next_slot(const std::string& directory) {
  return newest_checkpoint(directory) == "checkpoint/slot_0.h5" ? "checkpoint/slot_1.h5"
                                                                : "checkpoint/slot_0.h5";
}

/// Expands the fields to the full grid one after the other, so that only one of them takes memory at a time.
template <int Dim>
void write_slot(const OutputDirectory& directory, const std::string& slot, const DesignLayout<Dim>& layout,
                const CheckpointState& state) {
  Hdf5Writer writer(directory.comm(), directory.file(slot));
  for (const auto& [name, values] : state.fields()) {
    const std::vector<double> field = layout.to_grid(values);
    writer.write_field<Dim>(layout.grid, {name, layout.on_nodes, layout.components, field, false});
  }
  for (const auto& [name, values] : state.arrays()) writer.write_array(name, values);
  for (const auto& [name, value] : state.scalars()) writer.write_attribute(name, value);
  writer.write_attribute(scalar_checksum_name, checksum_of(state.scalars()));
  writer.close(true);
}

}  // namespace

std::string newest_checkpoint(const std::string& directory) {
  std::string slot = read_file_if_there(directory + "/checkpoint/newest");
  while (!slot.empty() && (slot.back() == '\n' || slot.back() == ' ')) slot.pop_back();
  return slot.empty() ? "" : "checkpoint/" + slot;
}

int verify_checkpoint(const std::string& path) {
  silence_hdf5();
  const MemoryFile copy;
  if (!copy_if_intact(path, copy)) throw_damaged(path, "the checksum of the file is wrong");
  const Hdf5File file(H5Fopen(copy.path().c_str(), H5F_ACC_RDONLY, access_without_name()));
  if (!file) throw_damaged(path, "it cannot be opened");
  const std::vector<std::string> names = dataset_names(file);
  for (const std::string& name : names) {
    const Hdf5Dataset dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT));
    const auto expected = dataset ? read_attribute(dataset, "checksum") : std::nullopt;
    const auto found = dataset ? checksum_of_dataset(dataset) : std::nullopt;
    if (!expected || !found) throw_damaged(path, "dataset '" + name + "' cannot be read");
    if (*expected != Json(*found)) throw_damaged(path, "the checksum of dataset '" + name + "' is wrong");
  }
  verify_scalars(path, file);
  return static_cast<int>(names.size());
}

template <int Dim>
void write_checkpoint(const OutputDirectory& directory, const DesignLayout<Dim>& layout,
                      const CheckpointState& state) {
  const MPI_Comm comm = directory.comm();
  directory.make_folder("checkpoint");
  const std::string slot = broadcast(comm, rank_of(comm) == 0 ? next_slot(directory.path()) : "");
  write_slot(directory, slot, layout, state);
  run_on_first(comm, [&] {
    const std::string path = directory.file(slot);
    if (verify_checkpoint(path) != static_cast<int>(state.fields().size() + state.arrays().size()))
      throw_damaged(path, "datasets are missing");
  });
  directory.write("checkpoint/newest", slot.substr(slot.find('/') + 1) + "\n");
}

FABSEQ_INSTANTIATE_FUNCTION(write_checkpoint);

}  // namespace fabseq
