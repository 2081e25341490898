// SPDX-License-Identifier: MIT
/// \file
/// HDF5 files that one rank writes, gathered slab by slab (docs/architecture.md says why they are not written
/// in parallel).
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

/// An HDF5 file under construction. It has a temporary name until close() renames it; without close() nothing
/// is left behind. All calls are collective on `comm`, and rank 0 writes, with POSIX calls. If a call fails,
/// it throws OutputError, naming the file, on all ranks, after which only the destructor may be called. The
/// ranks of the grids that fields live on must be the first of `comm`; fields of further ranks must be
/// copies. All datasets but stages have an attribute `checksum` of their bytes (fabseq/files/seal.h).
class Hdf5Writer {
 public:
  /// Creates the file that close() will call `path`.
  Hdf5Writer(MPI_Comm comm, const std::string& path);
  ~Hdf5Writer();
  Hdf5Writer(Hdf5Writer&&) = delete;

  /// Writes a field with axes [z][y][x] (2D [y][x]), followed by [component] if it has several. Groups in its
  /// name ("a/b") are created. A description becomes the dataset's attribute of that name.
  template <int Dim>
  void write_field(const Grid<Dim>& grid, const typename FieldSet<Dim>::Field& field);
  /// Writes all fields of a set.
  template <int Dim>
  void write_fields(const FieldSet<Dim>& fields);
  /// Writes one stage of a dataset [stage][z][y][x][component] in single precision, without the last axis if
  /// there is one component. One call per stage, in the order of the stages, of which there are `count`.
  template <int Dim>
  void write_stage(const Grid<Dim>& grid, const typename FieldSet<Dim>::Field& field, int stage, int count);
  /// Writes the numbers of these nodes, offsets in Grid::owned_nodes(), as a dataset of integers: as the
  /// whole grid counts its nodes, from 0, x fastest; ascending.
  template <int Dim>
  void write_node_numbers(const Grid<Dim>& grid, const std::string& name, const std::vector<int>& places);
  /// Writes rank 0's `values` as a dataset with one axis or, if `columns` > 0, as a table [row][column].
  void write_array(const std::string& name, std::span<const double> values, int columns = 0);
  /// Writes an attribute of the file itself: a number, integer, string or boolean, of rank 0.
  void write_attribute(const std::string& name, const Json& value);
  /// Completes the file and gives it its name; it is on the disk when the call returns. With `sealed`, the
  /// file gets a seal (fabseq/files/seal.h), by which a reader finds damage before HDF5 sees it: HDF5 may
  /// crash on a damaged file.
  void close(bool sealed = false);

 private:
  class File;

  /// Calls `write` on rank 0 with the values of each slab. Throws on all ranks what `write` throws.
  template <int Dim, class Write>
  void for_slabs(SlabGather<Dim>& slabs, Write&& write);
  /// Writes a field slab by slab from value number `first` of a dataset on. Returns the checksum of what was
  /// written on rank 0.
  template <int Dim>
  std::uint64_t write_slabs(SlabGather<Dim>& slabs, const std::string& name, std::int64_t first,
                            bool single_precision);

  std::unique_ptr<File> file_;
};

/// XDMF text for the fields of an HDF5 file that Hdf5Writer wrote. `hdf5_name`: its path relative to the XDMF
/// file. Not collective.
template <int Dim>
std::string hdf5_xdmf(const FieldSet<Dim>& fields, const std::string& hdf5_name);

/// Reads this rank's owned values of a field on the elements or nodes, by all ranks in parallel,
/// [element or node][component], lexicographic in the owned box. The dataset has axes [z][y][x][component]
/// (2D [y][x][component]), without the last one if there is one component; or it is one list in that order.
/// Collective on the grid's communicator. Throws InputError on all ranks, naming file and dataset (and the
/// config keys or options they come from), if one is missing or has another shape.
template <int Dim>
std::vector<double> read_field(const Grid<Dim>& grid, bool on_nodes, const std::string& file,
                               const std::string& dataset, const std::string& file_key = "field file",
                               const std::string& dataset_key = "field", int components = 1);

/// Reads a list of numbers of any length, the same on all ranks. Collective on `comm`. Throws InputError as
/// read_field() does, and also if the dataset has several axes.
std::vector<double> read_list(MPI_Comm comm, const std::string& file, const std::string& dataset,
                              const std::string& file_key, const std::string& dataset_key);
/// Reads `count` numbers, the same on all ranks: a list or, if `columns` > 0, also a table [row][column].
/// `meaning` says in error messages where that shape comes from. Collective on `comm`. Throws InputError as
/// read_field() does.
std::vector<double> read_list(MPI_Comm comm, const std::string& file, const std::string& dataset,
                              std::size_t count, const std::string& meaning, const std::string& file_key,
                              const std::string& dataset_key, int columns = 0);

}  // namespace fabseq
