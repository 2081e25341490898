// SPDX-License-Identifier: MIT
#include "fabseq/files/field_dump.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/mpi_struct.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/verdict.h"
#include "files/xdmf.h"

#include <mpi.h>

#include <bit>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <span>
#include <vector>

namespace fabseq {

namespace {

static_assert(std::endian::native == std::endian::little,
              "the files are little-endian and written as they lie in memory");

void require_success(int code, const std::string& file) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw OutputError("cannot write '" + file + "': " + std::string(text, static_cast<std::size_t>(length)));
}

/// MPI datatype of the part of the whole box that `owned` covers.
template <int Dim>
MPI_Datatype make_box_type(const IndexBox<Dim>& whole, const IndexBox<Dim>& owned, MPI_Datatype entity) {
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_create_subarray(Dim, whole.size.data(), owned.size.data(), owned.start.data(), MPI_ORDER_FORTRAN,
                           entity, &type);
  return type;
}

/// A file that all ranks of `comm` write together. Every member is collective on `comm`, and all but the
/// destructor throw OutputError on all ranks.
class SharedFile {
 public:
  /// The file `path` must exist.
  SharedFile(MPI_Comm comm, const std::string& path) : comm_(comm), path_(path) {
    const int opened = MPI_File_open(comm_, path_.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file_);
    // If not all ranks could open it, it stays open: closing is collective and would wait for the others.
    if (any(comm_, opened != MPI_SUCCESS)) file_ = MPI_FILE_NULL;
    run_on_all(comm_, [&] { require_success(opened, path_); });
  }

  SharedFile(SharedFile&&) = delete;
  ~SharedFile() {
    if (file_ != MPI_FILE_NULL) (void)MPI_File_close(&file_);
  }

  /// Writes this rank's values of a field that starts at byte `offset` of the file.
  template <int Dim>
  void write(const IndexBox<Dim>& whole, const IndexBox<Dim>& owned,
             const typename FieldSet<Dim>::Field& field, std::int64_t offset) {
    const MpiType entity = contiguous_type(field.components, field.single_precision ? MPI_FLOAT : MPI_DOUBLE);
    const MpiType box(make_box_type(whole, owned, entity));
    const int viewed = MPI_File_set_view(file_, offset, entity, box, "native", MPI_INFO_NULL);
    run_on_all(comm_, [&] { require_success(viewed, path_); });

    std::vector<double> room;
    const std::span<const double> all = field.whole(owned.count(), room);
    std::vector<float> rounded;
    if (field.single_precision) rounded.assign(all.begin(), all.end());
    const void* values = field.single_precision ? static_cast<const void*>(rounded.data()) : all.data();
    const int count = static_cast<int>(owned.count());
    MPI_Status status;
    const int written = MPI_File_write_at_all(file_, 0, values, count, entity, &status);
    run_on_all(comm_, [&] {
      require_success(written, path_);
      // MPI may report a full disk by a short count only.
      int arrived = 0;
      MPI_Get_count(&status, entity, &arrived);
      if (arrived != count)
        throw OutputError("cannot write '" + path_ + "': no space left on device (short write)");
    });
  }

  void close() {
    const int synced = MPI_File_sync(file_);
    const int closed = MPI_File_close(&file_);
    run_on_all(comm_, [&] {
      require_success(synced, path_);
      require_success(closed, path_);
    });
  }

 private:
  MPI_Comm comm_;
  std::string path_;
  MPI_File file_ = MPI_FILE_NULL;
};

template <int Dim>
IndexBox<Dim> whole_box(const Grid<Dim>& grid, bool on_nodes) {
  return on_nodes ? grid.all_nodes() : grid.all_elements();
}

/// Byte offset of each field, followed by the size of the file.
template <int Dim>
std::vector<std::int64_t> byte_offsets(const FieldSet<Dim>& fields) {
  std::vector<std::int64_t> offsets = {0};
  for (const auto& field : fields.fields) {
    const std::int64_t bytes = field.single_precision ? sizeof(float) : sizeof(double);
    offsets.push_back(offsets.back() +
                      whole_box(*fields.grid, field.on_nodes).count() * field.components * bytes);
  }
  return offsets;
}

/// Creates the file and allocates its room on the disk, on one rank, so that a missing folder or a full disk
/// never reaches the collective calls: Open MPI 4.1 gives up a failed collective write half way, and ranks
/// then hang in their next call.
void make_room(const std::string& path, std::int64_t bytes) {
  PosixFile file(path, O_WRONLY | O_CREAT | O_TRUNC);
  file.reserve(bytes);
  file.close();
}

template <int Dim>
void write_values(const FieldSet<Dim>& fields, const std::vector<std::int64_t>& offsets,
                  const std::string& path) {
  const Grid<Dim>& grid = *fields.grid;
  SharedFile file(grid.comm(), path);
  for (std::size_t i = 0; i < fields.fields.size(); ++i) {
    const auto& field = fields.fields[i];
    const IndexBox<Dim>& owned = field.on_nodes ? grid.owned_nodes() : grid.owned_elements();
    file.write<Dim>(whole_box(grid, field.on_nodes), owned, field, offsets[i]);
  }
  file.close();
}

}  // namespace

template <int Dim>
void write_field_dump(MPI_Comm comm, const FieldSet<Dim>& fields, const std::string& base,
                      std::optional<double> moment) {
  const bool writes = rank_of(comm) < size_of(fields.grid->comm());
  const std::string binary = base + ".bin";
  const std::string partial = partial_name(binary);
  const std::vector<std::int64_t> offsets = byte_offsets(fields);

  try {
    run_on_first(comm, [&] { make_room(partial, offsets.back()); });
    // Either all of the ranks that write fail or none.
    run_on_all(comm, [&] {
      if (writes) write_values(fields, offsets, partial);
    });
    run_on_first(comm, [&] {
      publish_file(binary);
      const std::string name = std::filesystem::path(binary).filename().string();
      const auto source = [&](std::size_t i) {
        return XdmfSource{R"(Format="Binary" Endian="Little" Seek=")" + std::to_string(offsets[i]) + '"',
                          name};
      };
      replace_file(base + ".xdmf", xdmf_text<Dim>(fields, source, moment));
    });
  } catch (const OutputError&) {
    run_on_first(comm, [&] { remove_quietly(partial); });
    throw;
  }
}

FABSEQ_INSTANTIATE_FUNCTION(write_field_dump);

}  // namespace fabseq
