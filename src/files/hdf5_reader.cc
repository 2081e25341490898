// SPDX-License-Identifier: MIT
#include "fabseq/base/hdf5.h"
#include "fabseq/files/hdf5_writer.h"

#include <algorithm>
#include <string>
#include <vector>

namespace fabseq {

namespace {

/// Reads a field that is stored as one list, [element or node][component], x fastest. Every rank reads from
/// its first value to its last and picks out its own.
template <int Dim>
std::vector<double> read_field_as_list(const IndexBox<Dim>& all, const IndexBox<Dim>& owned,
                                       const Hdf5ParallelDataset& data, int components) {
  Index<Dim> last = owned.start;
  for (int axis = 0; axis < Dim; ++axis) last[axis] += owned.size[axis] - 1;
  const std::int64_t first = all.offset(owned.start);
  const auto start = static_cast<hsize_t>(owned.count() == 0 ? 0 : first * components);
  const auto count =
      owned.count() == 0 ? 0 : static_cast<hsize_t>((all.offset(last) - first + 1) * components);
  const std::vector<double> values = data.read({&start, 1}, {&count, 1});
  std::vector<double> result(static_cast<std::size_t>(owned.count()) * components);
  owned.for_each([&](const Index<Dim>& index, std::int64_t offset) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>((all.offset(index) - first) * components),
                components, result.begin() + static_cast<std::ptrdiff_t>(offset * components));
  });
  return result;
}

}  // namespace

template <int Dim>
std::vector<double> read_field(const Grid<Dim>& grid, bool on_nodes, const std::string& file,
                               const std::string& dataset, const std::string& file_key,
                               const std::string& dataset_key, int components) {
  const Hdf5ParallelDataset data(grid.comm(), file, dataset, file_key, dataset_key);
  const IndexBox<Dim> all = on_nodes ? grid.all_nodes() : grid.all_elements();
  const IndexBox<Dim>& owned = on_nodes ? grid.owned_nodes() : grid.owned_elements();
  const auto values = static_cast<hsize_t>(all.count()) * components;
  if (data.shape().size() == 1 && data.shape()[0] == values)
    return read_field_as_list<Dim>(all, owned, data, components);
  std::vector<hsize_t> shape(Dim), start(Dim), count(Dim);  // slowest axis first
  for (int axis = 0; axis < Dim; ++axis) {
    shape[Dim - 1 - axis] = static_cast<hsize_t>(all.size[axis]);
    start[Dim - 1 - axis] = static_cast<hsize_t>(owned.start[axis]);
    count[Dim - 1 - axis] = static_cast<hsize_t>(owned.size[axis]);
  }
  std::string meaning =
      on_nodes ? "nodes of the grid, domain.elements plus 1 reversed" : "domain.elements reversed";
  // A single component may have an axis of its own.
  if (components > 1 || (data.shape().size() == Dim + 1 && data.shape().back() == 1)) {
    shape.push_back(static_cast<hsize_t>(components));
    start.push_back(0);
    count.push_back(shape.back());
    meaning += ", then the components";
  }
  data.require_shape(shape, meaning);
  return data.read(start, count);
}

std::vector<double> read_list(MPI_Comm comm, const std::string& file, const std::string& dataset,
                              std::size_t count, const std::string& meaning, const std::string& file_key,
                              const std::string& dataset_key, int columns) {
  const Hdf5ParallelDataset data(comm, file, dataset, file_key, dataset_key);
  std::vector<hsize_t> shape = {count};
  if (columns > 0 && !std::ranges::equal(data.shape(), shape))
    shape = {count / columns, static_cast<hsize_t>(columns)};
  data.require_shape(shape, meaning);
  return data.read(std::vector<hsize_t>(shape.size(), 0), shape);
}

std::vector<double> read_list(MPI_Comm comm, const std::string& file, const std::string& dataset,
                              const std::string& file_key, const std::string& dataset_key) {
  const Hdf5ParallelDataset data(comm, file, dataset, file_key, dataset_key);
  const hsize_t start = 0, extent = data.shape().empty() ? 1 : data.shape()[0];
  data.require_shape({&extent, 1}, "a list");
  return data.read({&start, 1}, {&extent, 1});
}

FABSEQ_INSTANTIATE_FUNCTION(read_field);

}  // namespace fabseq
