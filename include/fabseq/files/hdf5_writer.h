// SPDX-License-Identifier: MIT
/// \file
/// HDF5 files written by one rank, gathered slab by slab (docs/architecture.md says why not in parallel).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/files/field_set.h"

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

template <int Dim>
class SlabGather;

/// An HDF5 file under construction, written under a temporary name and renamed by close(). All calls are
/// collective on `comm`; rank 0 writes, with POSIX calls; the outcome of each call is known on all
/// ranks: OutputError on all of them, naming the file, after which only the destructor may be called. Without
/// close() nothing is left behind. The ranks of the grids that fields live on must be the first of `comm`;
/// what further ranks have must be copies. Apart from stages, datasets have an attribute `checksum`
/// (fabseq/files/seal.h) of their bytes.
class Hdf5Writer {
 public:
  Hdf5Writer(MPI_Comm comm, const std::string& path);
  ~Hdf5Writer();
  Hdf5Writer(Hdf5Writer&&) = delete;

  /// A field with axes [z][y][x] (2D [y][x]), and [component] if it has several. Groups in the name ("a/b")
  /// are made.
  template <int Dim>
  void write_field(const Grid<Dim>& grid, const typename FieldSet<Dim>::Field& field);
  /// All fields of a set.
  template <int Dim>
  void write_fields(const FieldSet<Dim>& fields);
  /// [stage][z][y][x][component] in single precision, one call a stage, stages in order; `count` stages in
  /// all.
  template <int Dim>
  void write_stage(const Grid<Dim>& grid, const typename FieldSet<Dim>::Field& field, int stage, int count);
  /// A plain array known on rank 0, or, of so many columns, a table [row][column].
  void write_array(const std::string& name, std::span<const double> values, int columns = 0);
  /// An attribute of the file itself: number, integer, string or boolean.
  void write_attribute(const std::string& name, const Json& value);
  /// An attribute of the file itself: 64 unsigned bits.
  void write_checksum(const std::string& name, std::uint64_t value);
  /// Flushes, closes, and gives the file its name; on the disk when it returns. `sealed`: with a seal
  /// (fabseq/files/seal.h), by which a reader finds damage before HDF5, which may crash of it.
  void close(bool sealed = false);

 private:
  class File;

  /// Writes a gathered field from value number `first` of a dataset on; returns the checksum (rank 0).
  template <int Dim>
  std::uint64_t write_slabs(SlabGather<Dim>& slabs, const std::string& name, std::int64_t first,
                            bool single_precision);

  std::unique_ptr<File> file_;
};

/// XDMF text for the fields of an HDF5 file written by Hdf5Writer; `hdf5_name` relative to the XDMF file.
template <int Dim>
std::string hdf5_xdmf(const FieldSet<Dim>& fields, const std::string& hdf5_name);

/// Reads the owned part of a field on the elements or nodes [z][y][x], or one list with x fastest, from a
/// file, by all ranks in parallel. Collective on the grid's communicator. Throws InputError on all ranks,
/// naming file and dataset (and the config keys or options they come from), if one is missing or has another
/// shape.
template <int Dim>
std::vector<double> read_field(const Grid<Dim>& grid, bool on_nodes, const std::string& file,
                               const std::string& dataset, const std::string& file_key = "field file",
                               const std::string& dataset_key = "field");

/// Reads a list of numbers of any length, the same on all ranks. Collective on `comm`; throws InputError like
/// read_field(), and where the dataset has several axes.
std::vector<double> read_list(MPI_Comm comm, const std::string& file, const std::string& dataset,
                              const std::string& file_key, const std::string& dataset_key);
/// Reads a list of `count` numbers, or, of so many columns, a table [row][column] of them, the same on all
/// ranks; `meaning`: where that shape comes from, for the message. Collective on `comm`; throws InputError
/// like read_field().
std::vector<double> read_list(MPI_Comm comm, const std::string& file, const std::string& dataset,
                              std::size_t count, const std::string& meaning, const std::string& file_key,
                              const std::string& dataset_key, int columns = 0);

}  // namespace fabseq
