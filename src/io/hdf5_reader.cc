#include "fabseq/base/hdf5.h"
#include "fabseq/io/hdf5_writer.h"

#include <array>

namespace fabseq {

namespace {

/// A field stored as one list, x fastest: every rank reads from its first element to its last and picks its own.
template <int Dim>
std::vector<double> read_list(const Grid<Dim>& grid, const Hdf5ParallelDataset& data) {
  const IndexBox<Dim>& owned = grid.owned_elements();
  Index<Dim> last = owned.start;
  for (int axis = 0; axis < Dim; ++axis) last[axis] += owned.size[axis] - 1;
  const auto first = static_cast<hsize_t>(grid.all_elements().offset(owned.start));
  const hsize_t count = static_cast<hsize_t>(grid.all_elements().offset(last)) - first + 1;
  const std::vector<double> values = data.read({&first, 1}, {&count, 1});
  std::vector<double> result(static_cast<std::size_t>(owned.count()));
  owned.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    result[offset] = values[grid.all_elements().offset(element) - static_cast<std::int64_t>(first)];
  });
  return result;
}

}  // namespace

template <int Dim>
std::vector<double> read_element_field(const Grid<Dim>& grid, const std::string& file,
                                       const std::string& dataset, const std::string& file_key,
                                       const std::string& dataset_key) {
  const Hdf5ParallelDataset data(grid.comm(), file, dataset, file_key, dataset_key);
  const auto elements = static_cast<hsize_t>(grid.all_elements().count());
  if (data.shape().size() == 1 && data.shape()[0] == elements) return read_list(grid, data);
  const IndexBox<Dim>& owned = grid.owned_elements();
  std::array<hsize_t, Dim> shape{}, start{}, count{};  // slowest axis first
  for (int axis = 0; axis < Dim; ++axis) {
    shape[Dim - 1 - axis] = static_cast<hsize_t>(grid.domain().elements[axis]);
    start[Dim - 1 - axis] = static_cast<hsize_t>(owned.start[axis]);
    count[Dim - 1 - axis] = static_cast<hsize_t>(owned.size[axis]);
  }
  data.require_shape(shape, "domain.elements reversed");
  return data.read(start, count);
}

template std::vector<double> read_element_field<2>(const Grid<2>&, const std::string&, const std::string&,
                                                   const std::string&, const std::string&);
template std::vector<double> read_element_field<3>(const Grid<3>&, const std::string&, const std::string&,
                                                   const std::string&, const std::string&);

}  // namespace fabseq
