// SPDX-License-Identifier: MIT
#include "fabseq/base/hdf5.h"

#include "fabseq/base/error.h"
#include "fabseq/base/input_file.h"
#include "fabseq/base/json.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/verdict.h"

#include <algorithm>
#include <array>
#include <utility>

namespace fabseq {

namespace {

/// Names of the datasets of a file, for the message about one that is missing.
std::string dataset_list(hid_t file) {
  const std::vector<std::string> names = dataset_names(file);
  if (names.empty()) return "the file has no datasets";
  constexpr std::size_t most = 10;
  std::string text = "the file has ";
  for (std::size_t i = 0; i < std::min(most, names.size()); ++i)
    text += (i == 0 ? "'" : ", '") + names[i] + "'";
  if (names.size() > most) text += ", ... (" + std::to_string(names.size()) + " in all)";
  return text;
}

bool is_numeric(hid_t dataset) {
  const Hdf5Datatype type(H5Dget_type(dataset));
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT || kind == H5T_ENUM;
}

std::vector<hsize_t> shape_of(hid_t dataset) {
  const Hdf5Dataspace space(H5Dget_space(dataset));
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) (void)H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

/// Where else than in its file a dataset's values are, "" if nowhere. What it names may be anything: reading
/// a pipe would never end, and a missing file reads as 0.
std::string place_elsewhere(hid_t dataset) {
  const Hdf5PropertyList creation(H5Dget_create_plist(dataset));
  if (H5Pget_external_count(creation) > 0) return "keeps its values in external files";
  if (H5Pget_layout(creation) == H5D_VIRTUAL) return "is virtual: its values are those of other datasets";
  return "";
}

/// Name of a compression; `in_file`: what the file calls it.
std::string filter_name(H5Z_filter_t filter, const char* in_file) {
  // Their numbers are registered at the HDF Group.
  constexpr std::pair<H5Z_filter_t, const char*> known[] = {
      {H5Z_FILTER_SZIP, "szip"}, {307, "bzip2"}, {32000, "lzf"},  {32001, "blosc"}, {32004, "lz4"},
      {32008, "bitshuffle"},     {32013, "zfp"}, {32015, "zstd"}, {32026, "blosc2"}};
  for (const auto& [number, name] : known)
    if (number == filter) return name;
  return *in_file != '\0' ? "'" + std::string(in_file) + "'" : "filter " + std::to_string(filter);
}

/// The compression of a dataset that this HDF5 library cannot undo; "" if it can undo all.
std::string unknown_compression(hid_t dataset) {
  const Hdf5PropertyList creation(H5Dget_create_plist(dataset));
  for (int i = 0; i < H5Pget_nfilters(creation); ++i) {
    std::array<char, 64> name{};
    std::size_t values = 0;
    unsigned flags = 0, abilities = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &values, nullptr,
                                               name.size() - 1, name.data(), nullptr);
    if (filter < 0) continue;
    const bool known = H5Zfilter_avail(filter) > 0 && H5Zget_filter_info(filter, &abilities) >= 0;
    if (!known || (abilities & H5Z_FILTER_CONFIG_DECODE_ENABLED) == 0)
      return filter_name(filter, name.data());
  }
  return "";
}

/// Opens a file on this rank alone.
Hdf5File open_alone(const std::string& file_name, const std::string& file_key) {
  const std::string problem = reading_problem(file_name);
  if (!problem.empty())
    throw InputError(file_key + ": cannot open '" + file_name + "' (" + problem +
                     "), needs a readable HDF5 file");
  if (H5Fis_hdf5(file_name.c_str()) <= 0)
    throw InputError(file_key + ": '" + file_name + "' is not an HDF5 file");
  Hdf5File file(H5Fopen(file_name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (!file) throw InputError(file_key + ": cannot read '" + file_name + "' (HDF5: " + hdf5_error() + ")");
  return file;
}

/// Checks the file and the dataset as this rank alone sees them.
void check_alone(const std::string& file_name, const std::string& dataset_name, const std::string& file_key,
                 const std::string& dataset_key) {
  const Hdf5File file = open_alone(file_name, file_key);
  const Hdf5Dataset dataset(dataset_name.empty() ? H5I_INVALID_HID
                                                 : H5Dopen2(file, dataset_name.c_str(), H5P_DEFAULT));
  if (!dataset)
    throw InputError(dataset_key + ": no dataset '" + dataset_name + "' in '" + file_name +
                     "': " + dataset_list(file));
  if (!is_numeric(dataset))
    throw InputError(dataset_key + ": dataset '" + dataset_name + "' of '" + file_name +
                     "' is not numeric, needs integers or floating point numbers");
  const std::string elsewhere = place_elsewhere(dataset);
  if (!elsewhere.empty())
    throw InputError(dataset_key + ": dataset '" + dataset_name + "' of '" + file_name + "' " + elsewhere +
                     "; needs them in the dataset itself");
  const std::string compression = unknown_compression(dataset);
  if (!compression.empty())
    throw InputError(
        dataset_key + ": dataset '" + dataset_name + "' of '" + file_name + "' is compressed with " +
        compression +
        ", which this HDF5 library cannot read; needs none or gzip (in h5py: compression=\"gzip\")");
}

}  // namespace

Hdf5PropertyList access_without_name() {
  Hdf5PropertyList access(H5Pcreate(H5P_FILE_ACCESS));
  (void)H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  (void)H5Pset_fapl_stdio(access);
  return access;
}

std::vector<std::string> dataset_names(hid_t file) {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5O_info_t* info, void* data) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  (void)H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, collect, &names, H5O_INFO_BASIC);
  return names;
}

void silence_hdf5() { (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

std::string hdf5_error() {
  std::string text;
  // Upward: the innermost call comes first, and it knows what went wrong.
  const auto take_first = [](unsigned position, const H5E_error2_t* entry, void* data) -> herr_t {
    if (position == 0 && entry->desc != nullptr) *static_cast<std::string*>(data) = entry->desc;
    return 0;
  };
  (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &text);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

bool hdf5_file_has(MPI_Comm comm, const std::string& file_name, const std::string& name,
                   const std::string& file_key) {
  silence_hdf5();
  bool found = false;
  run_on_first(comm,
               [&] { found = H5Lexists(open_alone(file_name, file_key), name.c_str(), H5P_DEFAULT) > 0; });
  return any(comm, found);
}

Hdf5ParallelDataset::Hdf5ParallelDataset(MPI_Comm comm, const std::string& file, const std::string& dataset,
                                         const std::string& file_key, const std::string& dataset_key)
    : comm_(comm),
      name_("dataset '" + dataset + "' of '" + file + "'"),
      file_key_(file_key),
      dataset_key_(dataset_key) {
  silence_hdf5();
  // One rank looks first, so that the usual faults never reach a collective call.
  run_on_first(comm, [&] { check_alone(file, dataset, file_key, dataset_key); });

  const Hdf5PropertyList access(H5Pcreate(H5P_FILE_ACCESS));
  (void)H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL);
  file_ = Hdf5File(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access));
  if (any(comm, !file_)) throw InputError(file_key + ": '" + file + "' cannot be opened by all ranks");
  dataset_ = Hdf5Dataset(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT));
  if (any(comm, !dataset_)) throw InputError(dataset_key + ": " + name_ + " cannot be opened by all ranks");
  shape_ = shape_of(dataset_);
}

void Hdf5ParallelDataset::require_shape(std::span<const hsize_t> expected, const std::string& meaning) const {
  if (std::equal(expected.begin(), expected.end(), shape_.begin(), shape_.end())) return;
  throw InputError(dataset_key_ + ": " + name_ + " has shape " + to_text(shape_) + ", needs " +
                   to_text(std::vector<hsize_t>(expected.begin(), expected.end())) + " (" + meaning + ")");
}

std::vector<double> Hdf5ParallelDataset::read(std::span<const hsize_t> start,
                                              std::span<const hsize_t> count) const {
  hsize_t total = 1;
  for (const hsize_t extent : count) total *= extent;
  std::vector<double> values(total);

  const Hdf5Dataspace in_file(H5Dget_space(dataset_));
  const Hdf5Dataspace in_memory(H5Screate_simple(1, &total, nullptr));
  if (total == 0) {
    (void)H5Sselect_none(in_file);
    (void)H5Sselect_none(in_memory);
  } else if (!count.empty()) {
    (void)H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  }
  const Hdf5PropertyList transfer(H5Pcreate(H5P_DATASET_XFER));
  (void)H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  const herr_t code = H5Dread(dataset_, H5T_NATIVE_DOUBLE, in_memory, in_file, transfer, values.data());
  if (any(comm_, code < 0)) throw InputError(file_key_ + ": " + name_ + " cannot be read");
  return values;
}

}  // namespace fabseq
