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

/// Sole owner of an HDF5 identifier; the destructor closes it. A negative identifier (a failed call) counts
/// as "nothing held": test the handle before use. The handle converts to hid_t for HDF5 calls. Do not put
/// predefined identifiers (H5T_NATIVE_DOUBLE, H5P_DEFAULT) into one.
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
  /// Closes now. Returns false if HDF5 reports an error, which for a file means that data could not be
  /// written. Returns true if nothing is held.
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

/// Keeps HDF5 from printing error stacks for the rest of the process. Call it before a module's first HDF5
/// call.
void silence_hdf5();

/// HDF5's own description of this rank's last failed call, for error messages; "" if there is none.
std::string hdf5_error();

/// File access properties for a file without a name in the file system, such as a MemoryFile, which HDF5's
/// default driver cannot open. Closing the file closes all objects that are still open in it.
Hdf5PropertyList access_without_name();

/// Sorted names of all datasets of an open file; datasets within groups have their path. Not collective.
std::vector<std::string> dataset_names(hid_t file);

/// Whether the file has an object called `name` at its top level. Collective on `comm`: rank 0 looks. Throws
/// InputError, which names `file_key`, on all ranks if there is no such file or if it is no HDF5 file.
bool hdf5_file_has(MPI_Comm comm, const std::string& file_name, const std::string& name,
                   const std::string& file_key);

/// A numeric dataset that all ranks of a communicator open for reading through MPI-IO. Construction, read()
/// and destruction are collective on that communicator. `file_key` and `dataset_key` are the JSON pointers
/// (or options) that errors name.
class Hdf5ParallelDataset {
 public:
  /// Throws InputError, the same on all ranks, if there is no such file, if it is no HDF5 file, or if it has
  /// no numeric dataset of that name. Numeric means integers, floating point numbers, or booleans as h5py
  /// writes them.
  Hdf5ParallelDataset(MPI_Comm comm, const std::string& file, const std::string& dataset,
                      const std::string& file_key, const std::string& dataset_key);

  /// Extent along each axis, slowest first.
  const std::vector<hsize_t>& shape() const { return shape_; }
  /// Throws InputError if the shape differs from `expected`. The message names `dataset_key`, what was found,
  /// `expected`, and `meaning`, which says where `expected` comes from ("domain.elements reversed"). Not
  /// collective.
  void require_shape(std::span<const hsize_t> expected, const std::string& meaning) const;
  /// Values of a box as double, last axis fastest. `start` and `count` have one entry per axis and lie within
  /// shape(). The box may differ between ranks and may be empty. Throws InputError on all ranks if a rank
  /// cannot read.
  std::vector<double> read(std::span<const hsize_t> start, std::span<const hsize_t> count) const;

 private:
  MPI_Comm comm_;
  std::string name_, file_key_, dataset_key_;
  std::vector<hsize_t> shape_;
  Hdf5File file_;  // closed after the dataset
  Hdf5Dataset dataset_;
};

}  // namespace fabseq
