// SPDX-License-Identifier: MIT
/// \file
/// HDF5 with C++ manners: handles that close themselves, no error stacks on the terminal, parallel reading of
/// a dataset.
#pragma once

#include <hdf5.h>
#include <mpi.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// Sole owner of an HDF5 identifier, closed with the handle. A negative identifier (a failed call) is held as
/// "nothing": test the handle before use. Converts to hid_t for HDF5 calls. Predefined identifiers
/// (H5T_NATIVE_DOUBLE, H5P_DEFAULT) are not to be put into one.
template <herr_t (*Close)(hid_t)>
class Hdf5Handle {
 public:
  Hdf5Handle() = default;
  /// Takes ownership of `id`, the result of an HDF5 call.
  explicit Hdf5Handle(hid_t id) : id_(id) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Hdf5Handle() { (void)close(); }

  operator hid_t() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }
  /// Closes now; false if HDF5 reports an error (data that could not be written, for a file). Nothing held:
  /// true.
  bool close() noexcept { return id_ < 0 || Close(std::exchange(id_, H5I_INVALID_HID)) >= 0; }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

using Hdf5File = Hdf5Handle<H5Fclose>;
using Hdf5Group = Hdf5Handle<H5Gclose>;
using Hdf5Dataset = Hdf5Handle<H5Dclose>;
using Hdf5Dataspace = Hdf5Handle<H5Sclose>;
using Hdf5Datatype = Hdf5Handle<H5Tclose>;
using Hdf5PropertyList = Hdf5Handle<H5Pclose>;
using Hdf5Attribute = Hdf5Handle<H5Aclose>;

/// Keeps HDF5 from printing error stacks, for the rest of the process. Call it before the first HDF5 call of
/// a module.
void silence_hdf5();

/// HDF5's own description of the last failed call of this rank ("" if there is none), for error messages.
std::string hdf5_error();

/// How to open a file that has no name in the file system, such as a MemoryFile: HDF5's default driver
/// insists on one. What is still open in it is closed with it.
Hdf5PropertyList access_without_name();

/// Names of all datasets of an open file, those within groups with their path, sorted. Not collective.
std::vector<std::string> dataset_names(hid_t file);

/// Whether a file has something of that name at its top level. Collective; throws InputError, which names
/// `file_key`, if there is no such file or it is no HDF5 file.
bool hdf5_file_has(MPI_Comm comm, const std::string& file_name, const std::string& name,
                   const std::string& file_key);

/// A numeric dataset opened by all ranks of a communicator for reading through MPI-IO. All members that say
/// so are collective. `file_key` and `dataset_key` are the JSON pointers (or options) that errors name.
class Hdf5ParallelDataset {
 public:
  /// Collective. Throws InputError, the same on all ranks, if there is no such file, it is no HDF5 file, or
  /// it has no numeric dataset of that name (integers, floating point numbers, or booleans as h5py writes
  /// them).
  Hdf5ParallelDataset(MPI_Comm comm, const std::string& file, const std::string& dataset,
                      const std::string& file_key, const std::string& dataset_key);

  /// Extent along each axis, slowest first.
  const std::vector<hsize_t>& shape() const { return shape_; }
  /// Throws InputError that names `dataset_key`, what was found and `expected` (with `meaning`, e.g.
  /// "domain.elements reversed") if the shape is another one.
  void require_shape(std::span<const hsize_t> expected, const std::string& meaning) const;
  /// Collective; the box may differ between ranks and may be empty. Values as double, last axis fastest.
  /// `start` and `count`: an entry for each axis, within shape().
  std::vector<double> read(std::span<const hsize_t> start, std::span<const hsize_t> count) const;

 private:
  MPI_Comm comm_;
  std::string name_, file_key_, dataset_key_;
  std::vector<hsize_t> shape_;
  Hdf5File file_;  // closed after the dataset
  Hdf5Dataset dataset_;
};

}  // namespace fabseq
