// SPDX-License-Identifier: MIT
#include "fabseq/files/hdf5_writer.h"

#include "fabseq/base/error.h"
#include "fabseq/base/hdf5.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/verdict.h"
#include "fabseq/files/hdf5_attribute.h"
#include "fabseq/files/seal.h"
#include "files/slab_gather.h"
#include "files/xdmf.h"

#include <algorithm>
#include <bit>
#include <exception>
#include <fcntl.h>
#include <map>
#include <optional>
#include <sys/resource.h>

namespace fabseq {

static_assert(std::endian::native == std::endian::little,
              "values are written as they lie in memory, little-endian");

/// The file on rank 0.
///
/// HDF5 does not survive a failed write: the state it keeps of the file crashes the process at its end. So
/// HDF5 works on a file in memory, to which it writes nothing but metadata, a few kilobytes. The values go
/// straight to the disk, to where HDF5 would have put them, and the metadata around them follow at the end.
class Hdf5Writer::File {
 public:
  File(MPI_Comm comm, const std::string& path) : comm_(comm), path_(path) {}
  ~File() {
    if (disk_) remove_quietly(partial_name(path_));
  }
  File(File&&) = delete;

  MPI_Comm comm() const { return comm_; }
  hid_t root() const { return file_; }

  void require(bool success) const {
    if (success) return;
    const std::string reason = hdf5_error();
    throw OutputError("cannot write '" + path_ + "'" + (reason.empty() ? "" : ": " + reason));
  }

  void create() {
    silence_hdf5();
    disk_.emplace(partial_name(path_), O_RDWR | O_CREAT | O_TRUNC);
    file_ = Hdf5File(H5Fcreate(memory_.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access_without_name()));
    require(static_cast<bool>(file_));
  }

  void create_dataset(const std::string& name, const std::vector<hsize_t>& shape, hid_t type) {
    require_room_for(shape, type);
    const Hdf5Dataspace space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
    const Hdf5PropertyList links(H5Pcreate(H5P_LINK_CREATE));
    (void)H5Pset_create_intermediate_group(links, 1);
    const Hdf5PropertyList creation(H5Pcreate(H5P_DATASET_CREATE));
    (void)H5Pset_obj_track_times(creation, false);  // so that the same run gives the same bytes
    (void)H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    (void)H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
    const Hdf5Dataset dataset(H5Dcreate2(file_, name.c_str(), type, space, links, creation, H5P_DEFAULT));
    require(static_cast<bool>(dataset));
    const auto bytes = static_cast<std::int64_t>(H5Dget_storage_size(dataset));
    const haddr_t offset = H5Dget_offset(dataset);
    require(bytes == 0 || offset != HADDR_UNDEF);
    if (bytes > 0) places_[name] = {static_cast<std::int64_t>(offset), bytes};
  }

  /// Writes values of a dataset, which are of its type, from number `first` on and adds their bytes to the
  /// checksum.
  template <class Value>
  void write_values(const std::string& name, std::int64_t first, std::span<const Value> values,
                    Checksum& checksum) const {
    if (values.empty()) return;
    const std::int64_t begin = first * static_cast<std::int64_t>(sizeof(Value));
    disk_->write_at(places_.at(name).offset + begin, values.data(), values.size_bytes());
    checksum.add(values.data(), values.size_bytes());
  }
  /// The same for numbers, which are rounded if the dataset has single precision.
  void write_values(const std::string& name, std::int64_t first, std::span<const double> values,
                    bool single_precision, Checksum& checksum) const {
    if (!single_precision) return write_values<double>(name, first, values, checksum);
    const std::vector<float> rounded(values.begin(), values.end());
    write_values<float>(name, first, rounded, checksum);
  }

  /// Writes an attribute of a dataset.
  void attach(const std::string& name, const char* attribute, const Json& value) const {
    const Hdf5Dataset dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT));
    require(dataset && fabseq::write_attribute(dataset, attribute, value));
  }

  void finish(bool sealed) {
    require(file_.close());
    std::vector<Place> places = {{memory_.size(), 0}};
    for (const auto& [name, place] : places_) places.push_back(place);
    std::sort(places.begin(), places.end(),
              [](const Place& a, const Place& b) { return a.offset < b.offset; });
    std::int64_t end_of_last = 0;
    for (const Place& place : places) {
      copy_metadata(end_of_last, place.offset);
      end_of_last = place.offset + place.bytes;
    }
    disk_->resize(memory_.size());
    if (sealed) seal_file(*disk_, memory_.size());
    disk_->sync();
    disk_->close();
    publish_file(path_);
    disk_.reset();
  }

 private:
  /// Where the values of a dataset are in the file, in bytes.
  struct Place {
    std::int64_t offset = 0, bytes = 0;
  };

  /// Throws OutputError for a dataset that the limit of file sizes (`ulimit -f`) leaves no room for: it holds
  /// for files in memory, too.
  void require_room_for(const std::vector<hsize_t>& shape, hid_t type) const {
    constexpr hsize_t metadata = 1 << 16;  // at most, until the next dataset or the end
    rlimit limit{};
    if (::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
    hsize_t size = 0, bytes = H5Tget_size(type);
    for (const hsize_t extent : shape) bytes *= extent;
    (void)H5Fget_filesize(file_, &size);
    if (size + bytes + metadata > limit.rlim_cur)
      throw OutputError("cannot write '" + path_ + "': File too large");
  }

  void copy_metadata(std::int64_t begin, std::int64_t end) const {
    std::vector<char> bytes;
    for (std::int64_t next = begin; next < end; next += static_cast<std::int64_t>(bytes.size())) {
      bytes.resize(static_cast<std::size_t>(std::min<std::int64_t>(end - next, 1 << 20)));
      require(memory_.read_at(next, bytes));
      disk_->write_at(next, bytes.data(), bytes.size());
    }
  }

  MPI_Comm comm_;
  std::string path_;
  MemoryFile memory_;
  Hdf5File file_;                  ///< in memory_
  std::optional<PosixFile> disk_;  ///< has the partial name until it is published
  std::map<std::string, Place> places_;
};

namespace {

hid_t type_of(bool single_precision) { return single_precision ? H5T_IEEE_F32LE : H5T_IEEE_F64LE; }

}  // namespace

Hdf5Writer::Hdf5Writer(MPI_Comm comm, const std::string& path) : file_(std::make_unique<File>(comm, path)) {
  run_on_first(comm, [&] { file_->create(); });
}

Hdf5Writer::~Hdf5Writer() = default;

template <int Dim, class Write>
void Hdf5Writer::for_slabs(SlabGather<Dim>& slabs, Write&& write) {
  const bool is_first = rank_of(file_->comm()) == 0;
  std::exception_ptr failure;  // rethrown when all slabs are gathered
  for (int slab = 0; slab < slabs.count(); ++slab) {
    const std::span<const double> values = slabs.gather(slab);
    if (!is_first || failure) continue;
    try {
      write(values);
    } catch (...) {
      failure = std::current_exception();
    }
  }
  run_on_first(file_->comm(), [&] {
    if (failure) std::rethrow_exception(failure);
  });
}

template <int Dim>
std::uint64_t Hdf5Writer::write_slabs(SlabGather<Dim>& slabs, const std::string& name, std::int64_t first,
                                      bool single_precision) {
  Checksum checksum;
  for_slabs<Dim>(slabs, [&](std::span<const double> values) {
    file_->write_values(name, first, values, single_precision, checksum);
    first += static_cast<std::int64_t>(values.size());
  });
  return checksum.value();
}

template <int Dim>
void Hdf5Writer::write_field(const Grid<Dim>& grid, const typename FieldSet<Dim>::Field& field) {
  SlabGather<Dim> slabs(file_->comm(), grid, field);
  run_on_first(file_->comm(),
               [&] { file_->create_dataset(field.name, slabs.shape(), type_of(field.single_precision)); });
  const std::uint64_t checksum = write_slabs(slabs, field.name, 0, field.single_precision);
  run_on_first(file_->comm(), [&] {
    file_->attach(field.name, "checksum", checksum);
    if (!field.description.empty()) file_->attach(field.name, "description", field.description);
  });
}

template <int Dim>
void Hdf5Writer::write_fields(const FieldSet<Dim>& fields) {
  for (const auto& field : fields.fields) write_field<Dim>(*fields.grid, field);
}

template <int Dim>
void Hdf5Writer::write_stage(const Grid<Dim>& grid, const typename FieldSet<Dim>::Field& field, int stage,
                             int count) {
  SlabGather<Dim> slabs(file_->comm(), grid, field);
  std::vector<hsize_t> shape = slabs.shape();
  shape.insert(shape.begin(), static_cast<hsize_t>(count));
  run_on_first(file_->comm(), [&] {
    if (stage == 0) file_->create_dataset(field.name, shape, type_of(true));
  });
  write_slabs(slabs, field.name, stage * slabs.size(), true);
}

void Hdf5Writer::write_array(const std::string& name, std::span<const double> values, int columns) {
  run_on_first(file_->comm(), [&] {
    Checksum checksum;
    const auto row = static_cast<hsize_t>(columns);
    file_->create_dataset(
        name,
        columns == 0 ? std::vector<hsize_t>{values.size()} : std::vector<hsize_t>{values.size() / row, row},
        type_of(false));
    file_->write_values(name, 0, values, checksum);
    file_->attach(name, "checksum", checksum.value());
  });
}

template <int Dim>
void Hdf5Writer::write_node_numbers(const Grid<Dim>& grid, const std::string& name,
                                    const std::vector<int>& places) {
  const auto count = static_cast<hsize_t>(sum(grid.comm(), static_cast<std::int64_t>(places.size())));
  const std::vector<double> marks(places.size(), 1.0);
  SlabGather<Dim> slabs(file_->comm(), grid, {name, true, 1, marks, false, &places});
  run_on_first(file_->comm(), [&] { file_->create_dataset(name, {count}, H5T_STD_I64LE); });
  Checksum checksum;
  std::int64_t node = 0, written = 0;
  for_slabs<Dim>(slabs, [&](std::span<const double> of_slab) {
    std::vector<std::int64_t> numbers;
    for (const double mark : of_slab) {
      if (mark != 0.0) numbers.push_back(node);
      ++node;
    }
    file_->write_values<std::int64_t>(name, written, numbers, checksum);
    written += static_cast<std::int64_t>(numbers.size());
  });
  run_on_first(file_->comm(), [&] { file_->attach(name, "checksum", checksum.value()); });
}

void Hdf5Writer::write_attribute(const std::string& name, const Json& value) {
  run_on_first(file_->comm(), [&] { file_->require(fabseq::write_attribute(file_->root(), name, value)); });
}

void Hdf5Writer::close(bool sealed) {
  run_on_first(file_->comm(), [&] { file_->finish(sealed); });
}

template <int Dim>
std::string hdf5_xdmf(const FieldSet<Dim>& fields, const std::string& hdf5_name) {
  return xdmf_text<Dim>(fields, [&](std::size_t i) {
    return XdmfSource{"Format=\"HDF\"", hdf5_name + ":/" + fields.fields[i].name};
  });
}

template void Hdf5Writer::write_field<2>(const Grid<2>&, const FieldSet<2>::Field&);
template void Hdf5Writer::write_field<3>(const Grid<3>&, const FieldSet<3>::Field&);
template void Hdf5Writer::write_fields<2>(const FieldSet<2>&);
template void Hdf5Writer::write_fields<3>(const FieldSet<3>&);
template void Hdf5Writer::write_node_numbers(const Grid<2>&, const std::string&, const std::vector<int>&);
template void Hdf5Writer::write_node_numbers(const Grid<3>&, const std::string&, const std::vector<int>&);
template void Hdf5Writer::write_stage<2>(const Grid<2>&, const FieldSet<2>::Field&, int, int);
template void Hdf5Writer::write_stage<3>(const Grid<3>&, const FieldSet<3>::Field&, int, int);
FABSEQ_INSTANTIATE_FUNCTION(hdf5_xdmf);

}  // namespace fabseq
